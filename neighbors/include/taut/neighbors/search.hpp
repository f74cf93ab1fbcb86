#pragma once
/// \file
/// From points to pair lists: cell list and k-d tree behind one call.

#include <array>
#include <span>
#include <string_view>
#include <taut/neighbors/pair_list.hpp>
#include <vector>

namespace taut {

/// Points as the search sees them: D coordinate arrays of n values each.
template <int D>
struct PointView {
  std::array<const double*, D> x{};
  Index n = 0;
};

enum class SearchMethod { cell_list, kd_tree };
/// "cell_list" or "kd_tree". \throws InputError naming the valid ones.
SearchMethod search_method(std::string_view name);

struct SearchOptions {
  SearchMethod method = SearchMethod::cell_list;
};

/// All pairs closer than `radius` (strictly).
/// \throws InputError for a non-finite point (named), a radius that is not positive, coincident points (both
/// named), or more pairs than the index type addresses.
template <int D>
PairList find_pairs(PointView<D> points, double radius, SearchOptions options = {});

/// With a radius for each particle: a and b are a pair when their distance is less than the larger of their radii,
/// so that lists stay symmetric (b in N(a) exactly when a in N(b)).
template <int D>
PairList find_pairs(PointView<D> points, std::span<const double> radii, SearchOptions options = {});

/// New order for locality: `order[new] = old`. Lattices (points on few distinct coordinates) are kept in
/// lexicographic order, last coordinate slowest; other clouds follow a space-filling curve of cells of size `cell`.
template <int D>
std::vector<Index> locality_order(PointView<D> points, double cell);

}  // namespace taut
