#include "kd_tree.hpp"

#include <nanoflann.hpp>

namespace taut::detail {
namespace {

template <int D>
struct Points {
  PointView<D> points;
  Radii radii;
  Level level;

  Index particle(std::size_t i) const {
    return level.members.empty() ? static_cast<Index>(i) : level.members[i];
  }
  std::size_t kdtree_get_point_count() const {
    return level.members.empty() ? static_cast<std::size_t>(points.n) : level.members.size();
  }
  double kdtree_get_pt(std::size_t i, std::size_t d) const { return points.x[d][particle(i)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// Receives candidates from the tree. nanoflann sums squares in an order of its own, so the tree is asked for
// a little more than the radius and every pair is tested with the arithmetic that all searches share.
template <int D>
struct Receiver {
  const Points<D>& points;
  const Slice<D>& slice;
  int lane;
  double reach2;
  LaneMasks& masks;
  unsigned& coincident_lanes;

  double worstDist() const { return reach2; }
  bool full() const { return true; }
  std::size_t size() const { return 0; }
  bool addPoint(double, Index i) {
    const Index b = points.particle(static_cast<std::size_t>(i));
    if (b == slice.first + lane) return true;
    double d2 = 0;
    for (int d = 0; d < D; ++d) {
      const double dx = slice.x[d][lane] - points.points.x[d][b];
      d2 = d == 0 ? dx * dx : d2 + dx * dx;
    }
    const double other_r2 = points.radii(b) * points.radii(b);
    if (d2 < std::max(slice.r2[lane], other_r2)) {
      if (d2 <= std::min(slice.r2[lane], other_r2) * coincident2) coincident_lanes |= 1u << lane;
      masks[b] = static_cast<std::uint8_t>(masks[b] | 1u << lane);
      masks.mark(&b, 1);
    }
    return true;
  }
};

}  // namespace

template <int D>
struct KdTree<D>::Tree {
  Points<D> points;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points<D>>, Points<D>, D, Index>
      index;

  Tree(const PointView<D>& p, const Radii& r, const Level& l)
      : points{p, r, l}, index(D, points, nanoflann::KDTreeSingleIndexAdaptorParams(16)) {}
};

template <int D>
KdTree<D>::KdTree(const PointView<D>& points, const Radii& radii, const Level& level)
    : tree_(std::make_unique<Tree>(points, radii, level)) {}
template <int D>
KdTree<D>::~KdTree() = default;
template <int D>
KdTree<D>::KdTree(KdTree&&) noexcept = default;

template <int D>
void KdTree<D>::collect(const Slice<D>& slice, Workspace& work, LaneMasks& masks) const {
  for (int l = 0; l < slice.count; ++l) {
    const double reach = std::max(slice.radius[l], tree_->points.level.radius) * (1 + 1e-6);
    Receiver<D> receiver{tree_->points, slice, l, reach * reach, masks, work.coincident};
    double at[D];
    for (int d = 0; d < D; ++d) at[d] = slice.x[d][l];
    tree_->index.findNeighbors(receiver, at, nanoflann::SearchParams(0, 0.0f, false));
  }
}

template class KdTree<1>;
template class KdTree<2>;
template class KdTree<3>;

}  // namespace taut::detail
