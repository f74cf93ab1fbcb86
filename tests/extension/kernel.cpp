// A kernel: its shape over q = r/h and the slope of that. What normalises it is found by quadrature.
#include <cmath>

#include "parts.hpp"

namespace {

// (1 - s)^6 (1 + 6 s + 35/3 s^2) of s = q / 2 (Wendland 1995).
double shape(double q) {
  const double s = q / 2;
  return std::pow(1 - s, 6) * (1 + 6 * s + 35.0 / 3 * s * s);
}
double slope(double q) {
  const double s = q / 2;
  return -56.0 / 3 * s * (1 + 5 * s) * std::pow(1 - s, 5) / 2;
}

}  // namespace

taut::KernelEntry wendland_c4() {
  return {.name = "wendland_c4",
          .line = "positive definite, four times differentiable (Wendland 1995)",
          .radius_factor = 2,
          .shape = shape,
          .slope = slope};
}
