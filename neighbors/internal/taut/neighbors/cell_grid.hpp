#pragma once
// Clusters sorted by cells, and the search for those near a box.

#include <cstdint>
#include <span>
#include <taut/base/fields.hpp>
#include <taut/neighbors/clusters.hpp>
#include <taut/neighbors/simd.hpp>
#include <vector>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

// A grid of cells as wide as the largest radius; a cluster belongs to the cell of its low corner, and rows of
// cells along x are contiguous in memory. Where the clusters fill their bounding box, cells are numbered
// densely. Where they do not (a far outlier, a diagonal line), each row begins at a hashed place of a table
// of about twice as many buckets as there are clusters: clusters of other rows that share a bucket are looked
// at too, nothing else. So memory is O(clusters) for any extent.
template <int D>
class CellGrid {
 public:
  struct Run {
    std::uint32_t begin, end;  // places in the sorted arrays
  };
  struct Workspace {
    std::vector<Run> runs;
    std::vector<Index> slices;
  };

  // Of those clusters that `members` picks, all slices where it is empty.
  CellGrid(const Clusters<D>& clusters, std::span<const Index> members, bool graded);

  // The slices of the clusters that may hold particles within `reach` of the box, or within their own radii,
  // in work.slices; returns their number. A slice may come repeatedly.
  std::size_t find(const Box<D>& box, double reach, Workspace& work) const;
  double radius() const { return radius_; }
  // A count of pairs that the clusters' particles surely have, known without a search.
  double least_pairs() const { return least_pairs_; }

 private:
  std::uint64_t row(double y, double z) const;
  double count_least_pairs(const std::uint8_t* inside) const;
  void find_runs(const Box<D>& box, double reach, std::vector<Run>& runs) const;
  template <bool graded>
  std::size_t filter(const Box<D>& box, double reach, Workspace& work) const;

  Index n_ = 0;
  bool graded_ = false, dense_ = false;
  double radius_ = 0, least_pairs_ = 0;
  double longest_[D] = {};   // no cluster is longer
  double low_[D], high_[D];  // cells in use
  double extent_[D];         // number of cells
  std::uint64_t buckets_ = 1;
  // Sorted by cell, with room at the end to fill a pack. Boxes relative to the corner of all, in units of the
  // largest radius, rounded outwards.
  double corner_[D];
  AlignedArray<float> lows_[D], highs_[D];
  AlignedArray<float> r2_;
  AlignedArray<Index> slice_;
  AlignedArray<std::uint32_t> start_;
};

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
