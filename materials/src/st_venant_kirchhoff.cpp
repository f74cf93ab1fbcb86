#include <taut/materials/lateral.hpp>

namespace taut {
namespace {

/// P = F S, S = lambda tr(E) I + 2 mu E, E = (F^T F - I) / 2. In plane stress S_33 = 0 gives the same law
/// with another lambda, whatever the thickness (which vanishes where E_33 = -1/2: the law has no sense
/// beyond, though P stays finite).
template <int D>
class StVenantKirchhoff final : public Hyperelastic<D> {
 public:
  explicit StVenantKirchhoff(const MaterialParameters& parameters)
      : Hyperelastic<D>(parameters),
        lambda_(in_plane_lambda<D>(parameters)),
        mu_(parameters.mu()),
        lateral_(lateral_hooke<D>(parameters)) {}

  std::string_view name() const override { return "st_venant_kirchhoff"; }
  bool has_lateral_state() const override { return true; }

  void stress(const StressBlock<D>& block) const override {
    block.energy || block.P_lateral ? evaluate<true>(block) : evaluate<false>(block);
  }

  double wave_speed(double stretch_min, double stretch_max, double, double) const override {
    // A = (N·S N) I + (lambda + mu) f f^T + mu F F^T with f = F N. For a unit vector a, N·S N <= lambda tr E
    // + mu (|f|² - 1), (a·f)² <= |f|² <= s², a·F F^T a <= s² with s the largest stretch; all at once where N
    // and a lie along s. The least eigenvalue counts where compression has made the law unstable.
    const double s = stretch_max, t = stretch_min;
    const double at_s = trace_of_green_strain<D - 1>(s), at_t = trace_of_green_strain<D - 1>(t);
    const double sides_high = lambda_ > 0 ? at_s : at_t, sides_low = lambda_ > 0 ? at_t : at_s;
    const double high =
        lambda_ * (sides_high + (s * s - 1) / 2) + mu_ * (s * s - 1) + (lambda_ + 2 * mu_) * s * s;
    const double low = lambda_ * (sides_low + (t * t - 1) / 2) + mu_ * (t * t - 1) + mu_ * t * t;
    return std::sqrt(std::max(high, -low) / this->density());
  }

 private:
  template <bool outputs>
  void evaluate(const StressBlock<D>& block) const {
    for (int p = 0; p < block.n; p += lanes) {
      const TensorPack<D> F = load_tensor<D>(block.F + p, block.stride);
      const TensorPack<D> E = green_strain(displacement_gradient(block, p, F));
      store_tensor(block.P + p, block.stride, product(F, hooke(E, lambda_, mu_)));
      if constexpr (outputs) {
        if (block.energy) store(block.energy + p, hooke_energy(E, lambda_, mu_));
        if (block.P_lateral) store_lateral(block, p, E, lateral_);
      }
    }
  }

  double lambda_, mu_;
  LateralHooke lateral_;
};

}  // namespace

MaterialEntry st_venant_kirchhoff_entry() {
  return {.name = "st_venant_kirchhoff",
          .line = "P = F S, S = λ tr(E) I + 2µ E, E = (Fᵀ F − I) / 2",
          .make = material_makers<StVenantKirchhoff>()};
}

}  // namespace taut
