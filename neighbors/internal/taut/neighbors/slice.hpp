#pragma once
// The eight particles that a search works for at once.

#include <algorithm>
#include <limits>
#include <taut/neighbors/search.hpp>

namespace taut::detail {

template <int D>
struct Slice {
  Index first = 0;     // particle of lane 0
  int count = 0;       // lanes in use
  double x[D][lanes];  // NaN in unused lanes: no comparison holds there
  double r2[lanes];    // radius squared
  double radius[lanes];
  double reach;  // the largest radius
};

// Radii, one for all or one a particle.
struct Radii {
  double one = 0;
  std::span<const double> each;  // empty: `one` holds
  bool coincident = false;       // whether points may be one
  bool graded() const { return !each.empty(); }
  double operator()(Index a) const { return graded() ? each[static_cast<std::size_t>(a)] : one; }
};

template <int D>
Slice<D> make_slice(const PointView<D>& points, const Radii& radii, Index s) {
  Slice<D> slice;
  slice.first = s * lanes;
  slice.count = std::min(lanes, static_cast<int>(points.n - slice.first));
  for (int l = 0; l < lanes; ++l) {
    const bool used = l < slice.count;
    for (int d = 0; d < D; ++d)
      slice.x[d][l] = used ? points.x[d][slice.first + l] : std::numeric_limits<double>::quiet_NaN();
    slice.radius[l] = used ? radii(slice.first + l) : 0;
    slice.r2[l] = slice.radius[l] * slice.radius[l];
  }
  slice.reach = *std::max_element(slice.radius, slice.radius + lanes);
  return slice;
}

// Distance over the smaller radius beyond which two points are two. Nothing in a double-precision simulation
// can keep points apart that are nearer.
inline constexpr double coincident = 1e-12;
inline constexpr double coincident2 = coincident * coincident;

}  // namespace taut::detail
