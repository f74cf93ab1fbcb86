#include "models.hpp"
#include "tensor_pack.hpp"

namespace taut {
namespace {

/// Hooke's law at small strain. The tangent is that of the undeformed body everywhere.
template <int D>
class LinearElastic final : public Hyperelastic<D> {
 public:
  explicit LinearElastic(const MaterialParameters& parameters)
      : Hyperelastic<D>(parameters), lambda_(in_plane_lambda<D>(parameters)), mu_(parameters.mu()) {}

  std::string_view name() const override { return "linear_elastic"; }

  void stress(const StressBlock<D>& block) const override {
    block.energy ? evaluate<true>(block) : evaluate<false>(block);
  }

  double wave_speed(double, double, double, double) const override { return Material<D>::wave_speed(); }

 private:
  template <bool energy>
  void evaluate(const StressBlock<D>& block) const {
    for (int p = 0; p < block.n; p += lanes) {
      const TensorPack<D> H = displacement_gradient(block, p, load_tensor<D>(block.F + p, block.stride));
      TensorPack<D> strain;
      for (int i = 0; i < D; ++i)
        for (int j = 0; j < D; ++j) strain(i, j) = 0.5 * (H(i, j) + H(j, i));
      store_tensor(block.P + p, block.stride, hooke(strain, lambda_, mu_));
      if constexpr (energy) store(block.energy + p, hooke_energy(strain, lambda_, mu_));
    }
  }

  double lambda_, mu_;
};

}  // namespace

TAUT_MATERIAL(linear_elastic, LinearElastic)

}  // namespace taut
