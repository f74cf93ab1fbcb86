#include <cmath>
#include <map>
#include <taut/neighbors/cell_search.hpp>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {
namespace {

// Clusters by half-octaves of their radii. Cells are as wide as the largest radius: whole octaves search a
// tenth longer, in cells too wide for many.
template <int D>
std::map<int, std::vector<Index>> levels_of(const Clusters<D>& clusters) {
  std::map<int, std::vector<Index>> levels;
  std::vector<Index>* level = nullptr;
  int last = 0;
  for (Index c = 0; c < clusters.end(); ++c) {
    if (!clusters.exists(c)) continue;
    const double r = clusters[c].radius;
    const int half_octave = std::ilogb(r * r);
    if (!level || half_octave != last) level = &levels[last = half_octave];
    level->push_back(c);
  }
  return levels;
}

}  // namespace

template <int D>
CellSearch<D>::CellSearch(const PointView<D>&, const Radii& radii, const Clusters<D>& clusters)
    : clusters_(clusters) {
  if (!radii.graded() && clusters.end() == clusters.slices()) {
    grids_.emplace_back(clusters_, std::span<const Index>(), false);
    return;
  }
  for (const auto& [half_octave, members] : levels_of(clusters_))
    grids_.emplace_back(clusters_, members, radii.graded());
}

template <int D>
double CellSearch<D>::least_pairs() const {
  double sum = 0;
  for (const CellGrid<D>& grid : grids_) sum += grid.least_pairs();
  return sum;
}

template <int D>
void CellSearch<D>::find(const SliceGroup<D>& group, Workspace& work, std::vector<Index>& slices) const {
  const auto near = [&](const Box<D>& box, double reach) {
    for (const CellGrid<D>& grid : grids_) {
      const std::size_t count = grid.find(box, reach, work.cells);
      work.near.insert(work.cells.slices.data(), count);
    }
  };
  if (group.compact) {
    near(group.box, group.reach);
  } else {
    for (const Cluster<D>& part : clusters_.parts_of(group.begin)) near(part.box, part.radius);
  }
  slices.clear();
  work.near.drain(slices);
}

template class CellSearch<1>;
template class CellSearch<2>;
template class CellSearch<3>;

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
