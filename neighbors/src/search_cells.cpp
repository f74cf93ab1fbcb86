#include <taut/neighbors/cell_search.hpp>
#include <taut/neighbors/slice_search.hpp>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

template <int D>
PairList search_cells(const PointView<D>& points, const Radii& radii) {
  return search_with<D, CellSearch<D>>(points, radii);
}

template PairList search_cells(const PointView<1>&, const Radii&);
template PairList search_cells(const PointView<2>&, const Radii&);
template PairList search_cells(const PointView<3>&, const Radii&);

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
