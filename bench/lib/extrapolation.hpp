#pragma once
/// \file
/// Orders of convergence, and limits from values at three spacings.

#include <array>
#include <string>

namespace taut::bench {

/// The exponent p of error ~ h^p between two spacings.
double order_between(double coarse_h, double coarse_error, double fine_h, double fine_error);

/// What values at three spacings say of the limit h → 0.
struct Extrapolated {
  bool ok = false;
  double limit = 0, order = 0;
  std::string why_not;  ///< unless ok
};

/// Richardson extrapolation: the limit f0 and the order p of f(h) = f0 + C h^p through three values at
/// falling spacings. Refused where the values do not move one way by falling amounts, or with an order
/// outside 0.5 … 4, for then they are not yet on such a curve (Roache 1998, chapter 5).
Extrapolated richardson(const std::array<double, 3>& h, const std::array<double, 3>& value);

}  // namespace taut::bench
