#pragma once
// Boxes of slices, and of the parts of slices whose particles are not near each other: what cells hold.

#include <span>
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

// Eight numbers a slice, to be loaded at once.
struct alignas(64) SliceBox {
  double low[3], radius, high[3], none;
};

// A slice of an ordered cloud is one cluster, a slice of particles that are far apart up to eight.
template <int D>
class Clusters {
 public:
  Clusters(const PointView<D>& points, const Radii& radii);

  Index slices() const { return static_cast<Index>(boxes_.size()); }
  const SliceBox& box(Index slice) const { return boxes_[static_cast<std::size_t>(slice)]; }
  bool whole(Index slice) const { return parts_of(slice).empty(); }
  // The clusters of a slice that is not whole.
  std::span<const Cluster<D>> parts_of(Index slice) const {
    const auto s = static_cast<std::size_t>(slice);
    return {parts_.data() + part_begin_[s], parts_.data() + part_begin_[s + 1]};
  }

  // All, by a number: a whole slice's is that of the slice, then come the parts.
  Index end() const { return slices() + static_cast<Index>(parts_.size()); }
  bool exists(Index c) const { return c >= slices() || whole(c); }
  Cluster<D> operator[](Index c) const {
    if (c >= slices()) return parts_[static_cast<std::size_t>(c - slices())];
    const SliceBox& b = box(c);
    Cluster<D> whole{{}, b.radius, c, std::min(lanes, particles_ - c * lanes)};
    for (int d = 0; d < D; ++d) {
      whole.box.low[d] = b.low[d];
      whole.box.high[d] = b.high[d];
    }
    return whole;
  }
  double radius(Index c) const {
    return c < slices() ? box(c).radius : parts_[static_cast<std::size_t>(c - slices())].radius;
  }

 private:
  Index particles_;
  AlignedArray<SliceBox> boxes_;
  std::vector<Index> part_begin_;  // by slice; one more at the end
  std::vector<Cluster<D>> parts_;
};

}  // namespace taut::detail
