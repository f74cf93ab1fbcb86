#pragma once
// Points sorted by cells, and the search for the neighbours of a slice in them.

#include <cstdint>
#include <vector>

#include "lane_masks.hpp"
#include "slice.hpp"

namespace taut::detail {

// A grid of cells as wide as the level's radius, half as wide along x; rows of cells along x are contiguous
// in memory. Where the points fill their bounding box, cells are numbered densely. Where they do not (a far
// outlier, a diagonal line), each row begins at a hashed place of a table of about twice as many buckets as
// there are points: points of other rows that share a bucket are candidates more, nothing else. So memory is
// O(points) for any extent.
template <int D>
class CellGrid {
 public:
  struct Run {
    std::uint32_t begin, end;  // places in the sorted arrays
  };
  struct Workspace {
    std::vector<Run> runs;
    std::vector<std::uint32_t> candidates;  // places in the sorted arrays
    std::vector<Index> hits;
    unsigned coincident = 0;  // lanes that lie on another particle
  };

  CellGrid(const PointView<D>& points, const Radii& radii, const Level& level);

  // Adds the level's pairs with the particles of the slice.
  void collect(const Slice<D>& slice, Workspace& work, LaneMasks& masks) const;
  // A count of pairs that the level surely holds, by the pigeonhole principle: no search needed.
  double least_pairs() const;

 private:
  struct Box {
    double low[D], high[D];
  };
  std::uint64_t row(double y, double z) const;
  template <bool graded>
  void collect_lanes(const Slice<D>& slice, int begin, int end, Workspace& work, LaneMasks& masks) const;
  void find_runs(const Box& box, double reach, std::vector<Run>& runs) const;
  template <bool graded>
  std::size_t filter(const Box& box, double reach, Workspace& work) const;
  template <bool graded>
  void test_candidates(const Slice<D>& slice, std::size_t count, Workspace& work, LaneMasks& masks) const;

  Index n_ = 0;
  bool graded_ = false, dense_ = false;
  double radius_ = 0;
  double size_[D];           // of a cell
  double low_[D], high_[D];  // cells in use
  double extent_[D];         // number of cells
  std::uint64_t buckets_ = 1;
  AlignedArray<double> x_[D];  // sorted by cell, NaN at the end to fill a pack
  AlignedArray<double> r2_;
  AlignedArray<Index> id_;
  AlignedArray<std::uint32_t> start_;
};

}  // namespace taut::detail
