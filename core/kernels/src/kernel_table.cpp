#include <fmt/format.h>

#include <array>
#include <bit>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/kernels/kernel_table.hpp>

namespace taut {
namespace {

// Coefficients of the cubic in u that takes the values f at u = 0, 1/4, 3/4, 1: the extrema of a Chebyshev
// polynomial, with both ends, so that neighbouring cubics meet.
std::array<double, 4> cubic_through(const std::array<double, 4>& f) {
  const double d1 = 4 * (f[1] - f[0]), d2 = 4.0 / 3 * (f[2] - f[0]), d3 = f[3] - f[0];
  // d(u) = (f(u) - f(0)) / u is quadratic: Newton's divided differences at 1/4, 3/4, 1.
  const double e12 = 2 * (d2 - d1), e23 = 4 * (d3 - d2), e123 = 4.0 / 3 * (e23 - e12);
  return {f[0], d1 - e12 / 4 + e123 * 3 / 16, e12 - e123, e123};
}

}  // namespace

KernelTable::KernelTable(const Kernel& kernel, double h)
    : support_(kernel.radius_factor() * h),
      scale_(1 / (support_ * support_)),
      value_(4 *
             (intervals + 1)),  // one more: just below the support t may be rounded up to the end of the last
      slope_over_r_(4 * (intervals + 1)) {
  if (!(h > 0) || !std::isfinite(h))
    throw InputError(fmt::format("kernel table: smoothing length {} is not positive and finite", h));
  constexpr std::array<double, 4> sample{0, 0.25, 0.75, 1};
  for (int i = 0; i <= intervals; ++i) {
    const double left = std::bit_cast<double>((first_interval + i) << shift);
    const double right = std::bit_cast<double>((first_interval + i + 1) << shift);
    std::array<double, 4> value{}, slope{};
    for (std::size_t k = 0; k < sample.size(); ++k) {
      const double q = std::sqrt(std::max(left + sample[k] * (right - left) - offset, 0.0));
      // At the ends the limits from within: at the support a truncated kernel jumps, at zero W'(r)/r is 0/0.
      const double inner = std::min(q, 1 - 1e-15), r = support_ * std::max(inner, 1e-3);
      value[k] = kernel.value(support_ * inner, h);
      slope[k] = kernel.derivative(r, h) / r;
    }
    const auto v = cubic_through(value), s = cubic_through(slope);
    for (std::size_t k = 0; k < 4; ++k) {
      value_[4 * static_cast<std::size_t>(i) + k] = v[k];
      slope_over_r_[4 * static_cast<std::size_t>(i) + k] = s[k];
    }
  }
}

}  // namespace taut
