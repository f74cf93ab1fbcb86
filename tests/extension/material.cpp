// A material: stress of the deformation gradient, its energy, and a bound of the wave speed. It has a
// parameter of its own and no law for plane stress.
#include <algorithm>
#include <cmath>

#include "parts.hpp"

namespace {

using namespace taut;

/// S = lambda tr(E) I + 2 mu (1 + k E:E) E, of the energy lambda/2 tr(E)^2 + mu E:E + mu k/2 (E:E)^2.
template <int D>
class Stiffening final : public Hyperelastic<D> {
 public:
  explicit Stiffening(const MaterialParameters& parameters)
      : Hyperelastic<D>(parameters),
        lambda_(parameters.lambda()),
        mu_(parameters.mu()),
        k_(number_of(parameters.other, "stiffening")) {}

  std::string_view name() const override { return "stiffening"; }

  void stress(const StressBlock<D>& block) const override {
    for (int p = 0; p < block.n; ++p) {
      Mat<D> F;
      for (int c = 0; c < D * D; ++c)
        F(c / D, c % D) = block.F[static_cast<std::size_t>(c) * block.stride + p];
      const Mat<D> E = 0.5 * (F.transpose() * F - Mat<D>::Identity());
      const double trace = E.trace(), square = E.squaredNorm();
      const Mat<D> P = F * (lambda_ * trace * Mat<D>::Identity() + 2 * mu_ * (1 + k_ * square) * E).eval();
      for (int c = 0; c < D * D; ++c)
        block.P[static_cast<std::size_t>(c) * block.stride + p] = P(c / D, c % D);
      if (block.energy)
        block.energy[p] = 0.5 * lambda_ * trace * trace + mu_ * square * (1 + 0.5 * k_ * square);
    }
  }

  double wave_speed(double stretch_min, double stretch_max, double, double) const override {
    // No better than it has to be: norms of the stress and of the tangent.
    const double e =
        0.5 * std::max(std::abs(stretch_max * stretch_max - 1), std::abs(stretch_min * stretch_min - 1));
    const double square = D * e * e;
    const double S = std::abs(lambda_) * D * e + 2 * mu_ * (1 + k_ * square) * e;
    const double tangent = lambda_ + 2 * mu_ * (1 + 3 * k_ * square);
    return std::sqrt((S + stretch_max * stretch_max * tangent) / this->density());
  }

 private:
  double lambda_, mu_, k_;
};

}  // namespace

taut::MaterialEntry stiffening() {
  return {.name = "stiffening",
          .line = "S = λ tr(E) I + 2µ (1 + k E:E) E: St. Venant–Kirchhoff that stiffens",
          .make = material_makers<Stiffening>(),
          .traits = {.plane_stress = false},
          .parameters = {number_parameter("stiffening", 10, Interval::non_negative(), "", "the factor k")}};
}
