#pragma once
/// \file
/// Powers and roots that a change of units by powers of two passes through without rounding.

#include <cmath>

namespace taut {

/// x^n by products; std::pow may round x and 2^k x differently.
constexpr double int_power(double x, int n) {
  double product = 1;
  for (int k = 0; k < (n < 0 ? -n : n); ++k) product *= x;
  return n < 0 ? 1 / product : product;
}

/// Edge of a D-dimensional cube of this volume.
template <int D>
double edge_of(double volume) {
  if constexpr (D == 1) return volume;
  if constexpr (D == 2) return std::sqrt(volume);
  // std::cbrt takes other ways for exponents of other signs: give it none.
  int exponent = 0;
  double fraction = std::frexp(volume, &exponent);
  const int thirds = exponent >= 0 ? exponent / 3 : -((2 - exponent) / 3);
  fraction = std::ldexp(fraction, exponent - 3 * thirds);
  return std::ldexp(std::cbrt(fraction), thirds);
}

}  // namespace taut
