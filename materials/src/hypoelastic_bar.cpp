#include <fmt/core.h>

#include <cmath>
#include <taut/base/error.hpp>
#include <taut/materials/hypoelastic_bar.hpp>

namespace taut {
namespace {

/// The bar at a given theta, and the sign of d(load)/d(theta).
struct Point {
  HypoelasticBarState state;
  double load, slope;
};

Point bar_at(double theta, double K, double mu, BarSides sides) {
  const double p = K * std::expm1(-theta), dp = -p - K;
  const double free_strain = theta / 3 + p / (2 * mu), d_free_strain = 1.0 / 3 + dp / (2 * mu);
  double lateral = 0, sum = 0, d_sum = 0, stress = 0, d_stress = 0;
  switch (sides) {
    case BarSides::free:
      lateral = free_strain;
      sum = 2 * free_strain;
      d_sum = 2 * d_free_strain;
      stress = -3 * p;
      d_stress = -3 * dp;
      break;
    case BarSides::plane_strain:
      lateral = sum = free_strain;
      d_sum = d_free_strain;
      stress = 2 * mu * theta / 3 - 2 * p;
      d_stress = 2 * mu / 3 - 2 * dp;
      break;
    case BarSides::confined:
      stress = 4 * mu * theta / 3 - p;
      d_stress = 4 * mu / 3 - dp;
      break;
  }
  const double area = std::exp(sum);
  return {{std::exp(theta - sum), std::exp(lateral), stress, std::exp(theta)},
          stress * area,
          area * (d_stress + stress * d_sum)};
}

}  // namespace

std::optional<HypoelasticBarState> hypoelastic_bar(const MaterialParameters& parameters, BarSides sides,
                                                   double load) {
  make_material<1>("hypoelastic", parameters);  // checks the parameters
  if (!std::isfinite(load))
    throw InputError(fmt::format("load = {}: the load of a bar must be finite", load));
  const double K = parameters.bulk(), mu = parameters.mu(), sign = load < 0 ? -1 : 1;
  const auto at = [&](double theta) { return bar_at(sign * theta, K, mu, sides); };
  const auto reached = [&](const Point& point) { return sign * point.load >= sign * load; };

  // Follow the path from rest: on it the load grows until it is reached or falls again.
  constexpr double step = 1.0 / 64, farthest = 16;
  double low = 0, high = 0;
  if (load == 0) return at(0).state;
  for (;;) {
    low = high;
    high += step;
    if (high > farthest) return std::nullopt;
    const Point point = at(high);
    if (reached(point)) break;
    if (point.slope > 0) continue;
    // The largest load lies within this step.
    double rising = low, falling = high;
    for (int i = 0; i < 100; ++i) {
      const double middle = (rising + falling) / 2;
      (at(middle).slope > 0 ? rising : falling) = middle;
    }
    if (!reached(at(rising))) return std::nullopt;
    high = rising;
    break;
  }

  // Newton's method, kept within the bracket.
  double theta = (low + high) / 2;
  for (int i = 0; i < 200 && low < high; ++i) {
    const Point point = at(theta);
    (reached(point) ? high : low) = theta;
    double next = theta - sign * (point.load - load) / point.slope;
    if (!(next > low && next < high)) next = (low + high) / 2;
    if (std::abs(next - theta) <= 1e-16 * std::abs(theta)) break;
    theta = next;
  }
  return at(theta).state;
}

}  // namespace taut
