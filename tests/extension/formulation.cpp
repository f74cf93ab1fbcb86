// A formulation: accelerations of the particles from their displacements. This one is the displacement form
// of total Lagrangian SPH in plain loops, with damping by mass: what it shows is all that a formulation must
// do.
#include <Eigen/LU>  // determinants
#include <algorithm>

#include "parts.hpp"

namespace {

using namespace taut;

template <int D>
class TlPlain final : public Formulation<D> {
  using Formulation<D>::p_;

 public:
  explicit TlPlain(const FormulationSetup<D>& setup)
      : Formulation<D>(setup), damping_(setup.method.number("damping")), Q_(size(), D * D) {
    // The traits ask for stresses: that is what the materials give.
    for (const auto& material : p_.materials)
      laws_.push_back(&dynamic_cast<const Hyperelastic<D>&>(*material));
    const Kernel kernel(setup.method.kernel, D);
    pairs_ = find_pairs_at_rest(p_, setup.method);
    Method stored = setup.method;  // vectors that these loops can read
    stored.pair_precision = PairPrecision::double_precision;
    op_ = make_operator<D>(stored, p_, pairs_, kernel,
                           setup.method.support_dx * p_.dx / kernel.radius_factor());
  }

  void update_accelerations(double t) override {
    if (!p_.mirror.empty()) p_.mirror.vectors(p_.u);
#pragma omp parallel for
    for (Index a = 0; a < p_.n; ++a) {
      const Mat<D> F = deformation_gradient(a);
      Q_.template set_mat<D>(at(a), p_.V.component(0)[a] * stress(a, F) * op_.M.template mat<D>(at(a)));
    }
    for (Index a = 0; a < p_.n && !this->failure_; ++a)
      if (!(deformation_gradient(a).determinant() > 0)) this->failure_ = Failure{"J <= 0", a};
    if (!p_.mirror.empty()) p_.mirror.tensors(Q_);
    // What the force is summed with: -G_ba.
    const double* adjoint = op_.adjoint(static_cast<const double*>(nullptr));
#pragma omp parallel for
    for (Index a = 0; a < p_.n; ++a) {
      Vec<D> force = Q_.template mat<D>(at(a)) * op_.sum.template vec<D>(at(a));
      pairs_.for_each(a, [&](Index b, std::int64_t k, int lane) {
        Vec<D> g;
        for (int d = 0; d < D; ++d) g[d] = adjoint[(k * D + d) * lanes + lane];
        force += Q_.template mat<D>(at(b)) * g;
      });
      p_.a.template set_vec<D>(at(a), force / p_.m.component(0)[a] - damping_ * p_.v.template vec<D>(at(a)));
    }
    this->finish_accelerations(t);
  }

  Fastest fastest() const override {
    double speed = 0;
    for (const auto* law : laws_) speed = std::max(speed, law->wave_speed());
    return {.wave_speed = speed, .length = 0.5 * p_.dx};
  }

  Mat<D> deformation_gradient(Index i) const override {
    Mat<D> H = Mat<D>::Zero();
    pairs_.for_each(i, [&](Index b, std::int64_t k, int lane) {
      H += (p_.u.template vec<D>(at(b)) - p_.u.template vec<D>(at(i))) * op_.vector(k, lane).transpose();
    });
    return Mat<D>::Identity() + H * op_.M.template mat<D>(at(i)).transpose();
  }
  Mat<D> first_piola_kirchhoff(Index i) const override { return stress(i, deformation_gradient(i)); }
  Mat<D> cauchy_stress(Index i) const override {
    return full_cauchy_stress(i).template topLeftCorner<D, D>();
  }
  Mat<3> full_cauchy_stress(Index i) const override { return law(i).cauchy_stress(deformation_gradient(i)); }
  double strain_energy() const override {
    double sum = 0;
    for (Index a = 0; a < p_.n; ++a) {
      double energy = 0;
      stress(a, deformation_gradient(a), &energy);
      sum += p_.modelled_share(a) * p_.V.component(0)[a] * energy;
    }
    return sum;
  }
  std::int64_t pairs() const override { return pairs_.pairs(); }
  std::size_t bytes() const override { return pairs_.bytes() + op_.bytes() + Q_.bytes(); }

 private:
  static std::size_t at(Index i) { return static_cast<std::size_t>(i); }
  std::size_t size() const { return static_cast<std::size_t>(p_.total); }
  const Hyperelastic<D>& law(Index i) const { return *laws_[p_.material[at(i)]]; }

  /// Materials take whole packs: here one particle, repeated.
  Mat<D> stress(Index i, const Mat<D>& F, double* energy = nullptr) const {
    double block[D * D * lanes], energies[lanes];
    for (int c = 0; c < D * D; ++c) std::fill_n(block + c * lanes, lanes, F(c / D, c % D));
    law(i).stress({lanes, lanes, block, block, energy ? energies : nullptr});
    if (energy) *energy = energies[0];
    Mat<D> P;
    for (int c = 0; c < D * D; ++c) P(c / D, c % D) = block[c * lanes];
    return P;
  }

  double damping_;
  std::vector<const Hyperelastic<D>*> laws_;
  PairList pairs_;
  PairOperator<D> op_;
  Field Q_;  ///< V_a P_a M_a
};

}  // namespace

taut::FormulationEntry tl_plain() {
  const FormulationTraits traits{};  // total Lagrangian, on pairs, with operators: as they are
  std::vector<Parameter> parameters = pair_parameters(traits);
  parameters.push_back(
      number_parameter("damping", 0, Interval::non_negative(), "1/s", "deceleration over velocity"));
  return {.name = "tl_plain",
          .line = "total Lagrangian, displacements, in plain loops",
          .fails = "where `tl_displacement` does, and it is slow",
          .make = formulation_makers<TlPlain>(),
          .traits = traits,
          .parameters = std::move(parameters)};
}
