#include "kd_tree.hpp"

#include <cmath>
#include <map>
#include <nanoflann.hpp>

namespace taut::detail {
namespace {

// Particles whose radii are alike are searched together. Without members all particles belong.
struct Level {
  std::vector<Index> members;
  double radius = 0;  // the largest
};

// One level an octave of radii.
std::vector<Level> levels_of(const Radii& radii, Index n) {
  if (!radii.graded()) return {Level{{}, radii.one}};
  std::map<int, Level> octaves;
  for (Index i = 0; i < n; ++i) {
    Level& level = octaves[std::ilogb(radii(i))];
    level.members.push_back(i);
    level.radius = std::max(level.radius, radii(i));
  }
  std::vector<Level> levels;
  for (auto& [octave, level] : octaves) levels.push_back(std::move(level));
  return levels;
}

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
  typename KdTree<D>::Workspace& work;

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
      if (d2 <= std::min(slice.r2[lane], other_r2) * coincident2) work.coincident |= 1u << lane;
      std::uint8_t& mask = work.masks.data()[b];
      mask = static_cast<std::uint8_t>(mask | 1u << lane);
      const Index s = b / lanes;
      work.near.insert(&s, 1);
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
KdTree<D>::KdTree(const PointView<D>& points, const Radii& radii) {
  for (const Level& level : levels_of(radii, points.n))
    trees_.push_back(std::make_unique<Tree>(points, radii, level));
}
template <int D>
KdTree<D>::~KdTree() = default;

template <int D>
unsigned KdTree<D>::search(const Slice<D>& slice, Workspace& work, SliceEncoder& encoder) const {
  work.coincident = 0;
  for (const auto& tree : trees_)
    for (int l = 0; l < slice.count; ++l) {
      const double reach = std::max(slice.radius[l], tree->points.level.radius) * (1 + 1e-6);
      Receiver<D> receiver{tree->points, slice, l, reach * reach, work};
      double at[D];
      for (int d = 0; d < D; ++d) at[d] = slice.x[d][l];
      tree->index.findNeighbors(receiver, at, nanoflann::SearchParams(0, 0.0f, false));
    }
  work.near.drain(0, [&](Index begin, Index end) {
    encoder.encode_masks(work.masks.data(), std::int64_t{begin} * lanes, std::int64_t{end} * lanes);
  });
  encoder.end_slice();
  return work.coincident;
}

template class KdTree<1>;
template class KdTree<2>;
template class KdTree<3>;

}  // namespace taut::detail
