#pragma once
// Slices, or parts of them, whose particles are near each other: what cells hold.

#include <taut/core/fields.hpp>
#include <vector>

#include "slice.hpp"

namespace taut::detail {

template <int D>
struct Box {
  double low[D], high[D];
};

// Consecutive particles of one slice.
template <int D>
struct Cluster {
  Box<D> box;
  double radius;  // the largest
  Index slice;
  int count;  // of particles
};

// The clusters of all particles in their order: a slice of an ordered cloud is one, a slice of particles that
// are far apart up to eight.
template <int D>
struct Clusters {
  Clusters(const PointView<D>& points, const Radii& radii);

  AlignedArray<Cluster<D>> all;
  std::vector<Index> begin;  // of each slice's clusters; one more at the end
};

}  // namespace taut::detail
