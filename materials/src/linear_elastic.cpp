#include <taut/materials/lateral.hpp>

namespace taut {
namespace {

/// Hooke's law at small strain. The tangent is that of the undeformed body everywhere, and the theory makes
/// no difference between P and the Cauchy stress.
template <int D>
class LinearElastic final : public Hyperelastic<D> {
 public:
  explicit LinearElastic(const MaterialParameters& parameters)
      : Hyperelastic<D>(parameters),
        lambda_(in_plane_lambda<D>(parameters)),
        mu_(parameters.mu()),
        lateral_(lateral_hooke<D>(parameters)) {}

  std::string_view name() const override { return "linear_elastic"; }
  bool has_lateral_state() const override { return true; }

  void stress(const StressBlock<D>& block) const override {
    block.energy || block.P_lateral ? evaluate<true>(block) : evaluate<false>(block);
  }
  Mat<3> cauchy_stress(const Mat<D>& F) const override { return nominal_state<D>(*this, F).P; }

  double wave_speed(double, double, double, double) const override { return Material<D>::wave_speed(); }

 private:
  template <bool outputs>
  void evaluate(const StressBlock<D>& block) const {
    for (int p = 0; p < block.n; p += lanes) {
      const TensorPack<D> H = displacement_gradient(block, p, load_tensor<D>(block.F + p, block.stride));
      TensorPack<D> strain;
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) strain(i, j) = 0.5 * (H(i, j) + H(j, i));
      store_tensor(block.P + p, block.stride, hooke(strain, lambda_, mu_));
      if constexpr (outputs) {
        if (block.energy) store(block.energy + p, hooke_energy(strain, lambda_, mu_));
        if (block.P_lateral)
          store_lateral(block, p, lateral_.stress * trace(strain), 1.0 + lateral_.strain * trace(strain));
      }
    }
  }

  double lambda_, mu_;
  LateralHooke lateral_;
};

}  // namespace

MaterialEntry linear_elastic_entry() {
  return {.name = "linear_elastic",
          .line = "small strain, P = σ(ε), ε = sym(F) − I; not objective: rotation makes stress",
          .make = material_makers<LinearElastic>()};
}

}  // namespace taut
