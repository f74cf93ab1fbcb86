#include <Eigen/Eigenvalues>
#include <cmath>
#include <taut/formulations/formulations.hpp>
#include <taut/formulations/updated_lagrangian.hpp>

namespace taut {

namespace {

/// f^n (R_a + R_b), added to the stresses of a pair (Gray, Monaghan & Swift, CMAME 190, 2001).
template <int D>
struct ArtificialStressTerm {
  static constexpr bool present = true;
  static constexpr int S = sym_components<D>;

  const Field& R;
  const KernelTable& table;
  double scale;  // 1 / W(dx), or 1 / dx^2 where the weight is the distance
  bool by_distance;
  int exponent;

  template <class At>
  TAUT_INLINE void add(Index i, Pack r2, const At& at, Pack (&T)[S]) const {
    Pack f = (by_distance ? r2 : table.value(r2)) * scale;
    if (by_distance)
      for (int l = 0; l < lanes; ++l) f[l] = std::sqrt(f[l]);
    Pack power = f;
    for (int n = 1; n < exponent; ++n) power *= f;
    for (int k = 0; k < S; ++k) T[k] += power * (load(R.component(k) + i) + at(R.component(k)));
  }
};

/// Updated Lagrangian SPH with artificial stress: R = -epsilon T in the principal directions in tension.
template <int D>
class UlArtificialStress final : public UpdatedLagrangian<D> {
  using Base = UpdatedLagrangian<D>;
  using Base::p_;
  static constexpr int S = Base::S;

 public:
  explicit UlArtificialStress(const FormulationSetup<D>& setup) : Base(setup), R_(p_.X.particles(), S) {
    const Method& m = setup.method;
    if (!(m.artificial_stress >= 0))
      throw InputError(fmt::format("artificial_stress = {} must not be negative", m.artificial_stress));
    if (m.artificial_stress_weight != "kernel" && m.artificial_stress_weight != "distance")
      throw InputError(fmt::format("unknown artificial_stress_weight \"{}\"; valid: kernel, distance",
                                   m.artificial_stress_weight));
    exponent_ = static_cast<int>(m.artificial_stress_exponent);
    if (exponent_ != m.artificial_stress_exponent || exponent_ < 1 || exponent_ > 16)
      throw InputError(fmt::format("artificial_stress_exponent = {} must be a whole number from 1 to 16",
                                   m.artificial_stress_exponent));
    by_distance_ = m.artificial_stress_weight == "distance";
    scale_ = by_distance_ ? 1 / (p_.dx * p_.dx) : 1 / this->kernel_.value(p_.dx, this->h_);
  }

  void update_accelerations(double t) override {
    this->update_stress();
    update_artificial_stress();
    this->acceleration_pass(ArtificialStressTerm<D>{R_, this->table_, scale_, by_distance_, exponent_});
    this->finish_accelerations(t);
  }

 private:
  void update_artificial_stress();
  Field R_;
  double scale_ = 0;
  bool by_distance_ = false;
  int exponent_ = 4;
};

template <int D>
void UlArtificialStress<D>::update_artificial_stress() {
  const double epsilon = this->method_.artificial_stress;
#pragma omp parallel for schedule(static) if (p_.n > parallel_from)
  for (Index i = 0; i < p_.n; ++i) {
    Mat<D> T;
    for (int c = 0; c < S; ++c) {
      const auto [r, q] = sym_axes<D>(c);
      T(r, q) = T(q, r) = this->T_.component(c)[i];
    }
    Mat<D> R = Mat<D>::Zero();
    if (T.allFinite()) {
      Eigen::SelfAdjointEigenSolver<Mat<D>> principal;
      if constexpr (D == 1)
        principal.compute(T);
      else
        principal.computeDirect(T);
      for (int k = 0; k < D; ++k) {
        const Vec<D> e = principal.eigenvectors().col(k);
        R -= epsilon * std::max(0.0, principal.eigenvalues()[k]) * e * e.transpose();
      }
    }
    for (int c = 0; c < S; ++c) {
      const auto [r, q] = sym_axes<D>(c);
      R_.component(c)[i] = R(r, q);
    }
  }
  if (!p_.mirror.empty()) p_.mirror.symmetric(R_);
}

}  // namespace

template <int D>
std::unique_ptr<Formulation<D>> make_ul_artificial_stress(const FormulationSetup<D>& setup) {
  return std::make_unique<UlArtificialStress<D>>(setup);
}
template std::unique_ptr<Formulation<1>> make_ul_artificial_stress<1>(const FormulationSetup<1>&);
template std::unique_ptr<Formulation<2>> make_ul_artificial_stress<2>(const FormulationSetup<2>&);
template std::unique_ptr<Formulation<3>> make_ul_artificial_stress<3>(const FormulationSetup<3>&);

}  // namespace taut
