#include <taut/materials/lateral.hpp>
#include <taut/materials/plane_stress_neo_hookean.hpp>

namespace taut {
namespace {

/// P = mu (F - F^-T) + lambda ln J F^-T, the derivative of mu (F:F - 3) / 2 - mu ln J + lambda ln²J / 2
/// (Bonet and Wood 1997, section 5.4.3).
/// Energies, and the diagonal of P, are written in H = F - I, where small strains do not cancel.
template <int D>
class NeoHookean final : public Hyperelastic<D> {
 public:
  explicit NeoHookean(const MaterialParameters& parameters)
      : Hyperelastic<D>(parameters), lambda_(parameters.lambda()), mu_(parameters.mu()) {}

  std::string_view name() const override { return "neo_hookean"; }
  bool has_lateral_state() const override { return true; }

  void stress(const StressBlock<D>& block) const override {
    const bool outputs = block.energy || block.P_lateral;
    if (is_plane_stress<D>(this->parameters_))
      outputs ? sheet<true>(block) : sheet<false>(block);
    else
      outputs ? solid<true>(block) : solid<false>(block);
  }

  double wave_speed(double stretch_min, double stretch_max, double J_min, double J_max) const override;

 private:
  template <bool outputs>
  void solid(const StressBlock<D>& block) const {
    for (int p = 0; p < block.n; p += lanes) {
      const TensorPack<D> F = load_tensor<D>(block.F + p, block.stride);
      const TensorPack<D> H = displacement_gradient(block, p, F), cof = cofactor(F);
      const Pack change = volume_change(H);
      const Pack log_J = pack_log1p(change);
      const Pack per_J = 1.0 / (1.0 + change), volumetric = lambda_ * log_J;
      TensorPack<D> P;
      for (int i = 0; i < D * D; ++i) P.c[i] = mu_ * F.c[i] + (volumetric - mu_) * per_J * cof.c[i];
      for (int i = 0; i < D; ++i)
        P(i, i) = (mu_ * (change * F(i, i) + excess_over_cofactor(H, i)) + volumetric * cof(i, i)) * per_J;
      store_tensor(block.P + p, block.stride, P);
      if constexpr (outputs) {
        if (block.energy)
          store(block.energy + p,
                mu_ * (0.5 * norm_squared(H) + (trace(H) - log_J)) + 0.5 * lambda_ * log_J * log_J);
        if (block.P_lateral) store_lateral(block, p, lambda_ * log_J, pack(1));
      }
    }
  }

  /// Plane stress. With P_33 = 0, lambda ln J = -mu (w - 1), w = F_33²: the in-plane P is mu (F - w F^-T).
  template <bool outputs>
  void sheet(const StressBlock<D>& block) const {
    for (int p = 0; p < block.n; p += lanes) {
      const TensorPack<D> F = load_tensor<D>(block.F + p, block.stride);
      const TensorPack<D> H = displacement_gradient(block, p, F), cof = cofactor(F);
      const Pack change = volume_change(H);
      const Pack log_J2 = pack_log1p(change);
      const SquaredThickness thickness = squared_thickness(log_J2, lambda_ / (2 * mu_));
      const Pack per_J = 1.0 / (1.0 + change);
      TensorPack<D> P;
      for (int i = 0; i < D * D; ++i) P.c[i] = mu_ * (F.c[i] - thickness.w * per_J * cof.c[i]);
      for (int i = 0; i < D; ++i)
        P(i, i) =
            mu_ * per_J * (change * F(i, i) + excess_over_cofactor(H, i) - thickness.excess * cof(i, i));
      store_tensor(block.P + p, block.stride, P);
      if constexpr (outputs) {
        if (block.energy) {
          const Pack log_J = log_J2 + 0.5 * log_of(thickness);
          store(block.energy + p,
                mu_ * (0.5 * norm_squared(H) + (trace(H) + 0.5 * thickness.excess - log_J)) +
                    0.5 * lambda_ * log_J * log_J);
        }
        if (block.P_lateral) store_lateral(block, p, pack(0), pack_sqrt(thickness.w));
      }
    }
  }

  /// F_ii less its cofactor, of F = I + H.
  TAUT_INLINE static Pack excess_over_cofactor(const TensorPack<D>& H, int i) {
    if constexpr (D == 1) return H.c[0];
    if constexpr (D == 2) return i == 0 ? H.c[0] - H.c[3] : H.c[3] - H.c[0];
    if constexpr (D == 3) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      return H(i, i) - H(j, j) - H(k, k) - (H(j, j) * H(k, k) - H(j, k) * H(k, j));
    }
  }
  /// k of the acoustic tensor A = mu I + k g g^T, g = F^-T N, at the volume ratio J.
  double normal_stiffness(double J) const {
    if (!is_plane_stress<D>(this->parameters_)) return mu_ + lambda_ * (1 - std::log(J));
    const double a = lambda_ / (2 * mu_);
    const double w = squared_thickness(pack(std::log(J)), a).w[0];
    return mu_ * w * (w + 3 * a) / (w + a);
  }

  double lambda_, mu_;
};

/// |g| is at most 1 / s with s the least stretch. k falls with J for lambda > 0 and grows for lambda < 0, in
/// plane stress too.
template <int D>
double NeoHookean<D>::wave_speed(double stretch_min, double stretch_max, double J_min, double J_max) const {
  if (!(stretch_min > 0)) return std::numeric_limits<double>::infinity();
  const StretchRange<D> range(stretch_min, stretch_max, J_min, J_max);
  const double g2 = 1 / (stretch_min * stretch_min);
  double k_max = normal_stiffness(lambda_ > 0 ? range.J_min : range.J_max);
  double k_min = normal_stiffness(lambda_ > 0 ? range.J_max : range.J_min);
  // A sheet with nu < 0 has no state below some J: none to bound.
  if (std::isnan(k_max)) k_max = 0;
  if (std::isnan(k_min)) k_min = 0;
  return std::sqrt(std::max(mu_ + std::max(k_max, 0.0) * g2, -mu_ - k_min * g2) / this->density());
}

}  // namespace

MaterialEntry neo_hookean_entry() {
  return {.name = "neo_hookean",
          .line = "P = µ (F − F⁻ᵀ) + λ ln J F⁻ᵀ (Bonet and Wood 1997)",
          .make = material_makers<NeoHookean>()};
}

}  // namespace taut
