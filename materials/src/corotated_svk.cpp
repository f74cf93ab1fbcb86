#include <taut/base/error.hpp>
#include <taut/materials/lateral.hpp>
#include <taut/materials/polar.hpp>

namespace taut {
namespace {

/// P = R S: the rotation R of F = R U where the St. Venant–Kirchhoff law has F itself. Objective; not the
/// derivative of any energy, and P F^T is not symmetric. In plane stress S_33 = 0, and R is the in-plane
/// rotation.
template <int D>
class CorotatedSvk final : public Hyperelastic<D> {
 public:
  explicit CorotatedSvk(const MaterialParameters& parameters)
      : Hyperelastic<D>(parameters),
        lambda_(in_plane_lambda<D>(parameters)),
        mu_(parameters.mu()),
        lateral_(lateral_hooke<D>(parameters)) {}

  std::string_view name() const override { return "corotated_svk"; }
  bool has_energy() const override { return false; }
  bool has_lateral_state() const override { return true; }

  void stress(const StressBlock<D>& block) const override {
    if (block.energy)
      throw InputError("material 'corotated_svk' has no stored energy: P = R S is not the derivative of one");
    for (int p = 0; p < block.n; p += lanes) {
      const TensorPack<D> F = load_tensor<D>(block.F + p, block.stride);
      const TensorPack<D> E = green_strain(displacement_gradient(block, p, F));
      store_tensor(block.P + p, block.stride, product(polar_rotation(F), hooke(E, lambda_, mu_)));
      if (block.P_lateral) lateral(block, p, E);
    }
  }

  double wave_speed(double stretch_min, double stretch_max, double, double) const override;

 private:
  /// Largest (S_i + S_j) / (2 (s_i + s_j)), i != j. In each stretch it is a convex or monotonic function over
  /// a positive linear one: it peaks in a corner of the range.
  double largest_mean_stress(double s, double t) const {
    double largest = -std::numeric_limits<double>::infinity();
    for (const double i : {s, t})
      for (const double j : {s, t})
        for (const double k : {s, t}) {
          const double trace = (i * i + j * j - 2 + (D == 3 ? k * k - 1 : 0)) / 2;
          largest = std::max(largest, (2 * lambda_ * trace + mu_ * (i * i + j * j - 2)) / (2 * (i + j)));
        }
    return largest;
  }

  /// R_kk = 1, hence P_kk = S_kk.
  void lateral(const StressBlock<D>& block, int p, const TensorPack<D>& E) const {
    const Pack tr = trace(E);
    store_lateral(block, p, lateral_.stress * tr, pack_sqrt(1.0 + (2 * lateral_.strain) * tr));
  }

  double lambda_, mu_;
  LateralHooke lateral_;
};

/// In the principal frame, with dF = a N^T, the tensor is A = (lambda + mu) N (U N)^T + mu U + G,
/// a·G a = sum over pairs i < j of c (p - q)² + d (p² - q²), p = a_i N_j, q = a_j N_i,
/// c = (S_i + S_j) / (2 (s_i + s_j)), |d| = mu |s_i - s_j| / 2. With a = cos N + sin M the sum of all (p -
/// q)² is sin², that of |p² - q²| at most 1, and (a·N)(a·U N) <= min(s, cos² s + (s - t) / 4).
template <int D>
double CorotatedSvk<D>::wave_speed(double stretch_min, double stretch_max, double, double) const {
  const double s = stretch_max, t = stretch_min;
  if constexpr (D == 1) return std::sqrt((lambda_ + 2 * mu_) * s / this->density());
  if (!(t > 0)) return std::numeric_limits<double>::infinity();
  const double c = std::max(0.0, largest_mean_stress(s, t)), d = mu_ * (s - t) / 2;
  const double stiff = (lambda_ + mu_) * s;
  const double high = mu_ * s + d + std::min(stiff + c, std::max(stiff, c) + (lambda_ + mu_) * (s - t) / 4);

  const double trace = trace_of_green_strain<D>(lambda_ > 0 ? t : s);
  const double least = std::min(0.0, (2 * lambda_ * trace + 2 * mu_ * (t * t - 1)) / (4 * t));
  const double low = mu_ * t - d + least - (lambda_ + mu_) * (s - t) / 4;
  return std::sqrt(std::max(high, -low) / this->density());
}

}  // namespace

MaterialEntry corotated_svk_entry() {
  return {.name = "corotated_svk",
          .line = "P = R S with F = R U: objective, not the derivative of an energy",
          .make = material_makers<CorotatedSvk>(),
          .traits = {.energy = false}};
}

}  // namespace taut
