#pragma once
// The search by cells: candidates slice by slice from grids of clusters, then every pair tested.

#include <vector>

#include "cell_grid.hpp"
#include "lane_masks.hpp"
#include "slice_encoder.hpp"
#include "slice_set.hpp"

namespace taut::detail {

template <int D>
class CellSearch {
 public:
  CellSearch(const PointView<D>& points, const Radii& radii);
  double least_pairs() const;

  struct Workspace {
    explicit Workspace(Index particles) : near(particles), masks(particles) {}
    SliceSet near;
    LaneMasks masks;
    typename CellGrid<D>::Workspace cells;
    struct Run {
      Index begin, end;  // particles
      bool ordered;      // to be tested along its diagonals
    };
    std::vector<Run> runs;
    std::vector<Index> candidates;
    std::vector<std::uint8_t> diagonals;
  };
  // Puts the pairs of the slice into the encoder. Returns the lanes that lie on another particle.
  unsigned search(const Slice<D>& slice, Workspace& work, SliceEncoder& encoder) const;

 private:
  using Run = typename Workspace::Run;
  void find_runs(const Slice<D>& slice, Workspace& work) const;
  bool ordered(const Slice<D>& slice, Index begin, Index end) const;
  template <bool graded>
  unsigned test(const Slice<D>& slice, Workspace& work, SliceEncoder& encoder) const;
  template <bool graded>
  std::size_t filter(const Slice<D>& slice, Workspace& work) const;
  template <bool graded>
  void test_candidates(const Slice<D>& slice, std::size_t count, Workspace& work, Double8& least) const;
  template <bool graded>
  void test_diagonals(const Slice<D>& slice, const Run& run, Workspace& work, SliceEncoder& encoder,
                      Double8& least) const;
  unsigned coincident_lanes(const Slice<D>& slice, const Workspace& work) const;

  PointView<D> points_;
  Radii radii_;
  Clusters<D> clusters_;
  std::vector<CellGrid<D>> grids_;                // one a half-octave of radii, so that cells suit them
  std::vector<std::uint8_t> ascending_;           // by slice: along x, and on to the next slice
  double last_x_[D][lanes], last_radius_[lanes];  // the last slice, padded with NaN
};

}  // namespace taut::detail
