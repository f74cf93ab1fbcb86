#include <cmath>
#include <map>
#include <taut/neighbors/kd_tree.hpp>
#include <taut/neighbors/nanoflann.hpp>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {
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

// Receives particles within reach from the tree.
template <int D>
struct Receiver {
  using DistanceType = double;
  using IndexType = Index;
  const Points<D>& points;
  double reach2;
  SliceSet& near;

  double worstDist() const { return reach2; }
  bool full() const { return true; }
  std::size_t size() const { return 0; }
  bool addPoint(double, Index i) {
    const Index s = points.particle(static_cast<std::size_t>(i)) / lanes;
    near.insert(&s, 1);
    return true;
  }
  void sort() {}  // newer versions name it, for searches that are to be sorted
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
KdTree<D>::KdTree(const PointView<D>& points, const Radii& radii, const Clusters<D>&)
    : points_(points), radii_(radii) {
  for (const Level& level : levels_of(radii, points.n))
    trees_.push_back(std::make_unique<Tree>(points, radii, level));
}
template <int D>
KdTree<D>::~KdTree() = default;

// nanoflann sums squares in an order of its own, so the tree is asked for a little more than the radius;
// every pair is tested with the arithmetic that all searches share.
template <int D>
void KdTree<D>::find(const SliceGroup<D>& group, Workspace& work, std::vector<Index>& slices) const {
  for (Index s = group.begin; s < group.end; ++s) work.near.insert(&s, 1);
  for (const auto& tree : trees_)
    for (Index a = group.begin * lanes; a < std::min(group.end * lanes, points_.n); ++a) {
      const double reach = std::max(radii_(a), tree->points.level.radius) * (1 + 1e-6);
      Receiver<D> receiver{tree->points, reach * reach, work.near};
      double at[D];
      for (int d = 0; d < D; ++d) at[d] = points_.x[d][a];
      tree->index.findNeighbors(receiver, at, unsorted_search());
    }
  slices.clear();
  work.near.drain(slices);
}

template class KdTree<1>;
template class KdTree<2>;
template class KdTree<3>;

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
