#include <algorithm>
#include <cmath>
#include <lib/measure.hpp>

namespace taut::bench {
namespace {

/// Extremum of largest size, by the parabola through the largest sample and its neighbours.
std::optional<double> peak(const Curve& c, std::size_t begin, std::size_t end) {
  if (begin == end) return {};
  std::size_t top = begin;
  for (std::size_t i = begin; i < end; ++i)
    if (std::abs(c.value[i]) > std::abs(c.value[top])) top = i;
  if (top == begin || top + 1 == end) return c.value[top];
  const double a = c.value[top - 1], b = c.value[top], d = c.value[top + 1];
  const double curvature = a - 2 * b + d;
  // Samples follow steps, whose spacing varies by a fraction of the interval: too little to matter at an
  // extremum.
  return curvature == 0 ? b : b - (d - a) * (d - a) / (8 * curvature);
}

}  // namespace

std::optional<double> measure(const ProbeSpec& probe, const Curve& c, const Curve& exact) {
  const auto at = [&](double t) {
    return static_cast<std::size_t>(std::lower_bound(c.t.begin(), c.t.end(), t) - c.t.begin());
  };
  const std::size_t begin = at(probe.window[0]);
  const std::size_t end = std::max(begin, probe.window[1] >= 1e300 ? c.t.size() : at(probe.window[1]));
  if (probe.measure == "peak") return peak(c, begin, end);
  if (probe.measure == "arrival_time") {
    const auto top = peak(c, begin, end);
    if (!top || *top == 0) return {};
    const double half = 0.5 * std::abs(*top);
    for (std::size_t i = begin; i < end; ++i) {
      if (std::abs(c.value[i]) < half) continue;
      if (i == 0) return c.t[0];
      const double low = std::abs(c.value[i - 1]), high = std::abs(c.value[i]);
      const double s = high > low ? (half - low) / (high - low) : 1;
      return c.t[i - 1] + s * (c.t[i] - c.t[i - 1]);
    }
    return {};
  }
  double difference = 0, scale = 0;
  for (std::size_t i = begin; i < end; ++i) {
    difference = std::max(difference, std::abs(c.value[i] - exact.value[i]));
    scale = std::max(scale, std::abs(exact.value[i]));
  }
  if (scale == 0) return {};
  return difference / scale;
}

}  // namespace taut::bench
