#pragma once
// The search through nanoflann's k-d tree: slower than cells, indifferent to how points are spread.

#include <memory>

#include "lane_masks.hpp"
#include "slice.hpp"

namespace taut::detail {

template <int D>
class KdTree {
 public:
  struct Workspace {
    unsigned coincident = 0;  // lanes that lie on another particle
  };

  KdTree(const PointView<D>& points, const Radii& radii, const Level& level);
  ~KdTree();
  KdTree(KdTree&&) noexcept;

  // Adds the level's pairs with the particles of the slice.
  void collect(const Slice<D>& slice, Workspace& work, LaneMasks& masks) const;
  double least_pairs() const { return 0; }

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace taut::detail
