#pragma once
// The search by cells: slices near a group from grids of clusters.

#include <taut/neighbors/cell_grid.hpp>
#include <taut/neighbors/slice_group.hpp>
#include <taut/neighbors/slice_set.hpp>
#include <vector>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

template <int D>
class CellSearch {
 public:
  CellSearch(const PointView<D>& points, const Radii& radii, const Clusters<D>& clusters);
  double least_pairs() const;

  struct Workspace {
    explicit Workspace(Index particles) : near(particles) {}
    SliceSet near;
    typename CellGrid<D>::Workspace cells;
  };
  // The slices that may hold particles which pair with one of the group, ascending.
  void find(const SliceGroup<D>& group, Workspace& work, std::vector<Index>& slices) const;

 private:
  const Clusters<D>& clusters_;
  std::vector<CellGrid<D>> grids_;  // one a half-octave of radii, so that cells suit them
};

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
