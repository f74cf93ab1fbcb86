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
    exponent_ = static_cast<int>(m.artificial_stress_exponent);
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

FormulationEntry ul_artificial_stress_entry() {
  std::vector<Parameter> parameters = updated_lagrangian_parameters();
  parameters.push_back(
      number_parameter("artificial_stress", 0.3, Interval::non_negative(), "", "the factor ε"));
  parameters.push_back(whole_parameter("artificial_stress_exponent", 4, 1, 16, "the exponent n"));
  parameters.push_back(
      choice_parameter("artificial_stress_weight", "kernel", {"kernel", "distance"}, "W(r)/W(dx), or r/dx"));
  return {.name = "ul_artificial_stress",
          .line = "the same with the artificial stress of Gray, Monaghan and Swift (2001)",
          .fails = "later in tension; too soft before",
          .make = formulation_makers<UlArtificialStress>(),
          .traits = updated_lagrangian_traits(),
          .parameters = std::move(parameters)};
}

}  // namespace taut
