#pragma once
/// \file
/// Bodies far from the origin of their coordinates.

#include <taut/base/types.hpp>
#include <taut/geometry/geometry.hpp>

namespace taut {

/// Whether what lies between two corners is so far from the origin that its coordinates have lost digits.
template <int D>
bool is_far(const Vec<D>& min, const Vec<D>& max);

/// a - b, coordinates that were rounded. Where that has cost the difference digits, the shortest decimal that
/// rounding leaves possible: 0.005, not 0.0049999998882, for 500000.005 - 500000. Others are as good a guess,
/// but lengths are mostly meant to be short ones.
double coordinate_difference(double a, double b);
template <int D>
Vec<D> coordinate_difference(const Vec<D>& a, const Vec<D>& b) {
  Vec<D> difference;
  for (int d = 0; d < D; ++d) difference[d] = coordinate_difference(a[d], b[d]);
  return difference;
}

/// What two coordinates of this size, that mean the same, may differ by.
double coordinate_rounding(double a);

/// Moves the origin of a cloud that lies far from it to its lower corner.
template <int D>
void make_local(Cloud<D>& cloud);

}  // namespace taut
