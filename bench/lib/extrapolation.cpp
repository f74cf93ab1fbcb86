#include <fmt/format.h>

#include <cmath>
#include <lib/extrapolation.hpp>

namespace taut::bench {

double order_between(double coarse_h, double coarse_error, double fine_h, double fine_error) {
  return std::log(coarse_error / fine_error) / std::log(coarse_h / fine_h);
}

Extrapolated richardson(const std::array<double, 3>& h, const std::array<double, 3>& f) {
  const double first = f[0] - f[1], second = f[1] - f[2];
  if (!(first * second > 0)) return {false, 0, 0, "values at three spacings are not monotone"};
  constexpr double least = 0.5, most = 4;
  // The ratio of the differences that a curve of order p has; it grows with p.
  const auto ratio = [&](double p) {
    return (std::pow(h[0], p) - std::pow(h[1], p)) / (std::pow(h[1], p) - std::pow(h[2], p));
  };
  const double wanted = first / second;
  if (wanted < ratio(least) || wanted > ratio(most))
    return {false, 0, 0,
            fmt::format("observed order is {} {:g}", wanted < ratio(least) ? "below" : "above",
                        wanted < ratio(least) ? least : most)};
  double low = least, high = most;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (ratio(middle) < wanted ? low : high) = middle;
  }
  const double p = 0.5 * (low + high);
  const double c = second / (std::pow(h[1], p) - std::pow(h[2], p));
  return {true, f[2] - c * std::pow(h[2], p), p, ""};
}

}  // namespace taut::bench
