#pragma once
// What is near a group of slices, copied to where each slice of the group finds it in cache.

#include <taut/base/fields.hpp>
#include <taut/neighbors/simd.hpp>
#include <taut/neighbors/slice_group.hpp>
#include <vector>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

// Slices near a group, ascending, with their boxes and particles in single precision: relative to the middle
// of the group and in units of the largest radius. Arrays end with a slice whose particles are infinitely far
// and with boxes that are near nothing, to fill packs.
template <int D>
struct Neighbourhood {
  // `slices` to be filled by a search before. Particles are not copied for a group that is not compact: their
  // distances are not worth rounding.
  void gather(const PointView<D>& points, const Radii& radii, const SliceGroup<D>& group);

  Index far_slice() const { return static_cast<Index>(slices.size()); }

  std::vector<Index> slices;
  bool compact = false;
  Index own = 0;  // place of the group's first slice
  // Squared distances of pairs that are nearer to each other than a radius or little farther, and of their
  // boxes, are off by less.
  float tolerance = 0;
  AlignedArray<float> low[D], high[D], reach2;  // boxes, and their largest radii squared
  AlignedArray<float> x[D], r2;                 // particles, eight a slice; r2 where radii differ only
};

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
