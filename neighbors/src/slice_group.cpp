#include <algorithm>
#include <taut/neighbors/slice_group.hpp>

namespace taut::detail {
namespace {

// A group's candidates are found once and looked at by each of its slices: many slices share the cost of
// finding, small boxes have fewer candidates.
constexpr Index most_slices = 16;
constexpr double largest_volume = 16;  // of the search, in that of one particle

template <int D>
double volume(const Box<D>& box, double reach) {
  double v = 1;
  for (int d = 0; d < D; ++d) v *= 1 + (box.high[d] - box.low[d]) / (2 * reach);
  return v;
}

template <int D>
Box<D> box_of(const PointView<D>& points, Index first, Index end) {
  Box<D> box;
  for (int d = 0; d < D; ++d) {
    const double* const x = points.x[d];
    double low = x[first], high = low;
    for (Index i = first + 1; i < end; ++i) {
      low = std::min(low, x[i]);
      high = std::max(high, x[i]);
    }
    box.low[d] = low;
    box.high[d] = high;
  }
  return box;
}

double largest_radius(const Radii& radii, Index first, Index end) {
  if (!radii.graded()) return radii.one;
  return *std::max_element(radii.each.data() + first, radii.each.data() + end);
}

}  // namespace

template <int D>
SliceGroup<D> group_from(const PointView<D>& points, const Radii& radii, const Clusters<D>& clusters,
                         Index begin, Index last) {
  SliceGroup<D> group{begin, begin, {}, 0, clusters.whole(begin)};
  for (last = std::min(last, begin + most_slices); group.end < last; ++group.end) {
    const Index first = group.end * lanes, end = std::min(first + lanes, points.n);
    Box<D> box = box_of(points, first, end);
    const double reach = std::max(group.reach, largest_radius(radii, first, end));
    if (group.end > begin) {
      if (!group.compact || !clusters.whole(group.end)) break;
      box.add(group.box);
      if (!(volume(box, reach) < largest_volume)) break;
    }
    group.box = box;
    group.reach = reach;
  }
  return group;
}

template SliceGroup<1> group_from(const PointView<1>&, const Radii&, const Clusters<1>&, Index, Index);
template SliceGroup<2> group_from(const PointView<2>&, const Radii&, const Clusters<2>&, Index, Index);
template SliceGroup<3> group_from(const PointView<3>&, const Radii&, const Clusters<3>&, Index, Index);

}  // namespace taut::detail
