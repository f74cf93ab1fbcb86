#include <fmt/format.h>

#include <taut/base/error.hpp>
#include <taut/neighbors/kd_tree.hpp>
#include <taut/neighbors/registry.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/neighbors/search_variants.hpp>
#include <taut/neighbors/slice_search.hpp>

namespace taut {
namespace {

using detail::Radii;

template <int D>
PairList search(const PointView<D>& points, const Radii& radii, SearchOptions options) {
  return options.method == SearchMethod::kd_tree ? detail::search_with<D, detail::KdTree<D>>(points, radii)
                                                 : detail::search_variants<D>().back().search(points, radii);
}

}  // namespace

const Registry<SearchEntry>& search_registry() {
  static const Registry<SearchEntry> all(
      "neighbour search",
      {{"cell_list", "cells of the size of the support, eight particles at a time", SearchMethod::cell_list},
       {"kd_tree", "a k-d tree (nanoflann): for clouds that leave most of their box empty",
        SearchMethod::kd_tree}});
  return all;
}

SearchMethod search_method(std::string_view name) { return search_registry().find(name).method; }

template <int D>
PairList find_pairs(PointView<D> points, double radius, SearchOptions options) {
  return search(points, Radii{radius, {}, options.coincident}, options);
}

template <int D>
PairList find_pairs(PointView<D> points, std::span<const double> radii, SearchOptions options) {
  if (radii.size() != static_cast<std::size_t>(points.n))
    throw InputError(
        fmt::format("{} radii for {} particles: each particle needs one", radii.size(), points.n));
  return search(points, points.n ? Radii{0, radii, options.coincident} : Radii{1, {}}, options);
}

template PairList find_pairs(PointView<1>, double, SearchOptions);
template PairList find_pairs(PointView<2>, double, SearchOptions);
template PairList find_pairs(PointView<3>, double, SearchOptions);
template PairList find_pairs(PointView<1>, std::span<const double>, SearchOptions);
template PairList find_pairs(PointView<2>, std::span<const double>, SearchOptions);
template PairList find_pairs(PointView<3>, std::span<const double>, SearchOptions);

}  // namespace taut
