#pragma once
// Boxes of slices, and of parts of slices whose particles are not near each other: cells are made of them.

#include <algorithm>
#include <span>
#include <taut/base/fields.hpp>
#include <taut/neighbors/slice.hpp>
#include <vector>

namespace taut::detail {

template <int D>
struct Box {
  double low[D], high[D];

  void add(const Box& other) {
    for (int d = 0; d < D; ++d) {
      low[d] = std::min(low[d], other.low[d]);
      high[d] = std::max(high[d], other.high[d]);
    }
  }
};

// Consecutive particles of one slice.
template <int D>
struct Cluster {
  Box<D> box;
  double radius;  // the largest
  Index slice;
  int count;  // of particles
};

// A slice of an ordered cloud is one cluster, a slice of particles that are far apart up to eight.
template <int D>
class Clusters {
 public:
  Clusters(const PointView<D>& points, const Radii& radii);

  Index slices() const { return slices_; }
  bool whole(Index slice) const { return parts_of(slice).empty(); }
  // The clusters of a slice that is not whole.
  std::span<const Cluster<D>> parts_of(Index slice) const {
    if (parts_.empty()) return {};
    const auto s = static_cast<std::size_t>(slice);
    return {parts_.data() + part_begin_[s], parts_.data() + part_begin_[s + 1]};
  }

  // All, by a number: a whole slice's is that of the slice, then come the parts.
  Index end() const { return slices() + static_cast<Index>(parts_.size()); }
  bool exists(Index c) const { return c >= slices() || whole(c); }
  const Cluster<D>& operator[](Index c) const {
    return c < slices() ? whole_[static_cast<std::size_t>(c)]
                        : parts_[static_cast<std::size_t>(c - slices())];
  }

  // Gives back the memory of whole slices, as much as a third of the list: grids are made from them, but what
  // is near a group is bounded anew.
  void drop_whole() { whole_ = {}; }

 private:
  Index slices_;
  AlignedArray<Cluster<D>> whole_;  // by slice
  std::vector<Index> part_begin_;   // by slice, one more at the end; empty where all are whole
  std::vector<Cluster<D>> parts_;
};

}  // namespace taut::detail
