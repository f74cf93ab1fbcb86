#pragma once
/// \file
/// From points to pair lists: cell list and k-d tree behind one call.

#include <array>
#include <span>
#include <string_view>
#include <taut/base/error.hpp>
#include <taut/base/fields.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <vector>

namespace taut {

/// Points as the search sees them: D coordinate arrays of n values each.
template <int D>
struct PointView {
  std::array<const double*, D> x{};
  Index n = 0;
};

/// The first n particles of a field of positions.
template <int D>
PointView<D> points_of(const Field& X, Index n) {
  PointView<D> view;
  for (int d = 0; d < D; ++d) view.x[static_cast<std::size_t>(d)] = X.component(d);
  view.n = n;
  return view;
}

/// Two points in one place, or nearly so.
class CoincidentPoints : public InputError {
 public:
  using InputError::InputError;
};

enum class SearchMethod { cell_list, kd_tree };
/// "cell_list" or "kd_tree". \throws InputError naming the valid ones.
SearchMethod search_method(std::string_view name);

struct SearchOptions {
  SearchMethod method = SearchMethod::cell_list;
  /// Points that coincide are pairs like others, for who will part them (`filter_pairs`), instead of an
  /// error.
  bool coincident = false;
};

/// All pairs closer than `radius` [m]: those with (dx² + dy²) + dz² < radius², each operation rounded to
/// double in this order. That is symmetric to the last bit and the same for both methods, whose lists are
/// identical. Memory is O(points + pairs) whatever the extent of the points; any finite coordinates will do.
/// \throws InputError for a coordinate that is not finite (particle named), a radius that is not positive and
/// finite, CoincidentPoints (nearer than 1e-12 radii; both named), or InputError for a list of more slots
/// than an Index counts.
template <int D>
PairList find_pairs(PointView<D> points, double radius, SearchOptions options = {});

/// With a radius for each particle: a and b are a pair when their distance is less than the larger of their
/// radii, so that lists stay symmetric (b in N(a) exactly when a in N(b)). Coincident is nearer than 1e-12 of
/// the smaller one. \throws InputError as above, naming the particle whose radius is bad, and for a wrong
/// number of radii.
template <int D>
PairList find_pairs(PointView<D> points, std::span<const double> radii, SearchOptions options = {});

/// New order for locality: `order[new] = old`. Lattices (points on few distinct coordinates, rounding aside)
/// are put in lexicographic order, last coordinate slowest; other clouds follow a Hilbert curve of cells of
/// size `cell` [m], those of more than 8 points halved up to four times, and within a cell the coordinates,
/// last slowest. Depends on the positions alone. \throws
/// InputError for a coordinate that is not finite, a cell size that is not positive and finite.
template <int D>
std::vector<Index> locality_order(PointView<D> points, double cell);

}  // namespace taut
