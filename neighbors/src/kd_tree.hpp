#pragma once
// The search through nanoflann's k-d tree: slower than cells, indifferent to how points are spread.

#include <memory>
#include <vector>

#include "lane_masks.hpp"
#include "slice.hpp"
#include "slice_encoder.hpp"
#include "slice_set.hpp"

namespace taut::detail {

template <int D>
class KdTree {
 public:
  struct Workspace {
    explicit Workspace(Index particles) : near(particles), masks(particles) {}
    SliceSet near;
    LaneMasks masks;
    unsigned coincident = 0;  // lanes that lie on another particle
  };

  KdTree(const PointView<D>& points, const Radii& radii);
  ~KdTree();

  double least_pairs() const { return 0; }
  // Puts the pairs of the slice into the encoder. Returns the lanes that lie on another particle.
  unsigned search(const Slice<D>& slice, Workspace& work, SliceEncoder& encoder) const;

 private:
  struct Tree;
  std::vector<std::unique_ptr<Tree>> trees_;  // one an octave of radii
};

}  // namespace taut::detail
