#pragma once
// Consecutive slices that are near each other, to be searched for together.

#include <taut/neighbors/clusters.hpp>

namespace taut::detail {

template <int D>
struct SliceGroup {
  Index begin, end;  // slices
  Box<D> box;
  double reach;  // the largest radius
  bool compact;  // all particles are in a box of a few radii; else there is one slice only
};

// The group that begins with slice `begin` and ends before `last` at the latest.
template <int D>
SliceGroup<D> group_from(const PointView<D>& points, const Radii& radii, const Clusters<D>& clusters,
                         Index begin, Index last);

}  // namespace taut::detail
