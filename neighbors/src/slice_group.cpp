#include "slice_group.hpp"

#include <algorithm>

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

}  // namespace

template <int D>
SliceGroup<D> group_from(const Clusters<D>& clusters, Index begin, Index last) {
  SliceGroup<D> group{begin, begin + 1, {}, clusters.box(begin).radius, clusters.whole(begin)};
  for (int d = 0; d < D; ++d) {
    group.box.low[d] = clusters.box(begin).low[d];
    group.box.high[d] = clusters.box(begin).high[d];
  }
  if (!group.compact) return group;
  for (; group.end < std::min(last, begin + most_slices) && clusters.whole(group.end); ++group.end) {
    const SliceBox& next = clusters.box(group.end);
    Box<D> box;
    for (int d = 0; d < D; ++d) {
      box.low[d] = std::min(group.box.low[d], next.low[d]);
      box.high[d] = std::max(group.box.high[d], next.high[d]);
    }
    const double reach = std::max(group.reach, next.radius);
    if (!(volume(box, reach) < largest_volume)) break;
    group.box = box;
    group.reach = reach;
  }
  return group;
}

template SliceGroup<1> group_from(const Clusters<1>&, Index, Index);
template SliceGroup<2> group_from(const Clusters<2>&, Index, Index);
template SliceGroup<3> group_from(const Clusters<3>&, Index, Index);

}  // namespace taut::detail
