#include <taut/materials/models.hpp>
#include <taut/materials/tensor_pack.hpp>

namespace taut {
namespace {

/// ds/dt = 2 mu dev(d) + W s - s W with d = sym(L), W = skew(L) (Jaumann's rate), sigma = s - p I,
/// p = K (rho / rho0 - 1), drho/dt = -rho tr(d) (Gray, Monaghan and Swift 2001).
/// Plane stress: d_33 follows from dsigma_33/dt = 0.
template <int D>
class JaumannHypoelastic final : public Hypoelastic<D> {
 public:
  explicit JaumannHypoelastic(const MaterialParameters& parameters)
      : Hypoelastic<D>(parameters), K_(parameters.bulk()), mu_(parameters.mu()) {}

  std::string_view name() const override { return "hypoelastic"; }

  void rate(const RateBlock<D>& block) const override {
    is_plane_stress<D>(this->parameters_) ? rates<true>(block) : rates<false>(block);
  }

  void stress(const RateBlock<D>& block) const override {
    const double factor = K_ / this->density();
    for (int p = 0; p < block.n; p += lanes) {
      const Pack pressure = factor * load(block.rho + p) - K_;
      Pack sigma[sym_components<D>];
      for (int c = 0; c < sym_components<D>; ++c) sigma[c] = load(block.s + c * block.stride + p);
      for (int c = 0; c < D; ++c) sigma[c] -= pressure;
      for (int c = 0; c < sym_components<D>; ++c) store(block.sigma + c * block.stride + p, sigma[c]);
    }
  }

  double wave_speed(double stretch_min, double stretch_max, double J_min, double J_max) const override;

 private:
  template <bool plane_stress>
  void rates(const RateBlock<D>& block) const {
    for (int p = 0; p < block.n; p += lanes) {
      const TensorPack<D> L = load_tensor<D>(block.L + p, block.stride);
      const Pack rho = load(block.rho + p);
      Pack s[sym_components<D>];
      for (int c = 0; c < sym_components<D>; ++c) s[c] = load(block.s + c * block.stride + p);

      Pack divergence = trace(L);
      if constexpr (plane_stress) {
        const Pack K = (K_ / this->density()) * rho;
        divergence -= divergence * (K - 2 * mu_ / 3) / (K + 4 * mu_ / 3);
      }
      const Pack third = divergence / 3.0;

      Pack s_rate[sym_components<D>];
      for (int i = 0; i < D; ++i) s_rate[i] = 2 * mu_ * (L(i, i) - third);
      if constexpr (D == 2) {
        const Pack w = 0.5 * (L(0, 1) - L(1, 0));
        s_rate[2] = mu_ * (L(0, 1) + L(1, 0)) + w * (s[1] - s[0]);
        s_rate[0] += 2.0 * w * s[2];
        s_rate[1] -= 2.0 * w * s[2];
      } else if constexpr (D == 3) {
        constexpr int at[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}}, row[3] = {1, 0, 0}, column[3] = {2, 2, 1};
        for (int c = 0; c < 3; ++c) s_rate[3 + c] = mu_ * (L(row[c], column[c]) + L(column[c], row[c]));
        TensorPack<3> W, S;
        for (int i = 0; i < 3; ++i)
          for (int j = 0; j < 3; ++j) {
            W(i, j) = 0.5 * (L(i, j) - L(j, i));
            S(i, j) = s[at[i][j]];
          }
        const TensorPack<3> WS = product(W, S);
        for (int i = 0; i < 3; ++i)
          for (int j = i; j < 3; ++j) s_rate[at[i][j]] += WS(i, j) + WS(j, i);
      }
      for (int c = 0; c < sym_components<D>; ++c) store(block.s_rate + c * block.stride + p, s_rate[c]);
      store(block.rho_rate + p, -rho * divergence);
    }
  }

  /// ln J of a sheet in plane stress with the in-plane J2, strained without rotation:
  /// s_33 = 2 mu (theta - ln J2 - theta / 3) equals p = K (exp(-theta) - 1).
  double sheet_log_volume(double log_J2) const {
    // Concave and increasing in theta: after its first step Newton's method comes from the left and cannot
    // overshoot.
    double theta = 0;
    for (int i = 0; i < 100; ++i) {
      const double step = (4 * mu_ / 3 * theta - K_ * std::expm1(-theta) - 2 * mu_ * log_J2) /
                          (4 * mu_ / 3 + K_ * std::exp(-theta));
      theta -= step;
      if (std::abs(step) <= 1e-15) break;
    }
    return theta;
  }

  double K_, mu_;
};

/// Assumes that the body was strained from rest along fixed principal axes, s = 2 mu dev(ln U); the law
/// itself bounds nothing. With g = F^-T N = |g| n, A(N) = J |g|² Q(n), |g| <= 1 / s, a·Q a = mu + (M - mu)
/// (a·n)² + (n·sigma n - a·sigma a) / 2, M = K / J + 4 mu / 3, where the last term is at most mu ln(s_max /
/// s_min) |sin(a, n)|. Everything times J grows with J. In plane stress M is the modulus of the plate at this
/// density, and the change of thickness adds -k (a·n) (a·sigma n), k = (K / J - 2 mu / 3) / (K / J + 4 mu /
/// 3).
template <int D>
double JaumannHypoelastic<D>::wave_speed(double stretch_min, double stretch_max, double J_min,
                                         double J_max) const {
  const double s = stretch_min;
  if (!(s > 0)) return std::numeric_limits<double>::infinity();
  if constexpr (D == 1) return std::sqrt((K_ / s + 4 * mu_ / 3) / s / this->density());
  const StretchRange<D> range(stretch_min, stretch_max, J_min, J_max);
  const double deviation = mu_ * std::log(stretch_max / stretch_min);
  double J = range.J_max, thinning = 0, M = K_ / J + 4 * mu_ / 3;
  if (is_plane_stress<D>(this->parameters_)) {
    const double high = std::log(range.J_max), low = std::log(range.J_min);
    const double theta_high = sheet_log_volume(high), theta_low = sheet_log_volume(low);
    const double strain_3_max = std::max(theta_high - high, theta_low - low);
    const double strain_3_min = std::min(theta_high - high, theta_low - low);
    const double sigma_min = 2 * mu_ * (std::log(stretch_min) - strain_3_max);
    const double sigma_max = 2 * mu_ * (std::log(stretch_max) - strain_3_min);
    const auto k = [&](double theta) {
      const double K = K_ * std::exp(-theta);
      return (K - 2 * mu_ / 3) / (K + 4 * mu_ / 3);
    };
    const double spread = (sigma_max - sigma_min) / 8;
    thinning = std::max({0.0, k(theta_low) * (std::max(0.0, -sigma_min) + spread),
                         -k(theta_high) * (std::max(0.0, sigma_max) + spread)});
    J = std::exp(theta_high);
    const double K = K_ / J;
    M = 4 * mu_ * (K + mu_ / 3) / (K + 4 * mu_ / 3);
  }
  const double b = M - mu_;
  const double peak = deviation < 2 * b ? b + deviation * deviation / (4 * b) : deviation;
  return std::sqrt(J * (mu_ + peak + thinning) / (s * s * this->density()));
}

}  // namespace

MaterialEntry hypoelastic_entry() {
  return {.name = "hypoelastic",
          .line = "Jaumann rate of the deviatoric stress, p = K (ρ / ρ0 − 1) (Gray, Monaghan and Swift 2001)",
          .make = material_makers<JaumannHypoelastic>(),
          .traits = {.kind = MaterialKind::rate, .energy = false}};
}

}  // namespace taut
