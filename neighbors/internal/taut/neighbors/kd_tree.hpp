#pragma once
// The search through nanoflann's k-d tree: slower than cells, indifferent to how points are spread.

#include <memory>
#include <taut/neighbors/slice_group.hpp>
#include <taut/neighbors/slice_set.hpp>
#include <vector>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

template <int D>
class KdTree {
 public:
  struct Workspace {
    explicit Workspace(Index particles) : near(particles) {}
    SliceSet near;
  };

  KdTree(const PointView<D>& points, const Radii& radii, const Clusters<D>& clusters);
  ~KdTree();

  double least_pairs() const { return 0; }
  // The slices that may hold particles which pair with one of the group, ascending.
  void find(const SliceGroup<D>& group, Workspace& work, std::vector<Index>& slices) const;

 private:
  struct Tree;
  PointView<D> points_;
  Radii radii_;
  std::vector<std::unique_ptr<Tree>> trees_;  // one an octave of radii
};

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
