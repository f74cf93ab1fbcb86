#include <fmt/format.h>

#include <atomic>
#include <bit>
#include <taut/core/error.hpp>
#include <taut/neighbors/search.hpp>

#include "cell_search.hpp"
#include "kd_tree.hpp"
#include "pair_list_builder.hpp"
#include "parallel.hpp"
#include "point_check.hpp"
#include "slice_encoder.hpp"

namespace taut {
namespace {

using detail::Radii;

// Chunks go to the threads in ascending order and a fault stops only those after it, so that the lowest fault
// is found whatever the number of threads.
template <int D, class Searcher>
PairList search(const PointView<D>& points, const Radii& radii) {
  detail::check_points(points);
  detail::check_radii(radii, points.n);
  PairListBuilder builder(points.n);
  if (points.n == 0) return builder.build();

  const Searcher searcher(points, radii);
  PairListBuilder::check_slots(searcher.least_pairs() / lanes, points.n);

  std::atomic<Index> next_chunk{0}, first_coincident{points.n};
  std::atomic<std::int64_t> slots{0};
  constexpr std::int64_t most_slots = std::numeric_limits<Index>::max();
  detail::ParallelError error;
#pragma omp parallel if (detail::worth_threads(points.n))
  error.guard([&] {
    detail::SliceEncoder encoder(points.n);
    typename Searcher::Workspace work(points.n);
    for (Index c = next_chunk++; c < builder.chunks(); c = next_chunk++) {
      std::int64_t counted = 0;
      for (Index s = builder.begin_slice(c); s < builder.end_slice(c); ++s) {
        if (s * lanes > first_coincident || slots > most_slots) return;
        const auto slice = detail::make_slice(points, radii, s);
        if (const unsigned coincident = searcher.search(slice, work, encoder)) {
          const Index a = slice.first + std::countr_zero(coincident);
          Index known = first_coincident;
          while (a < known && !first_coincident.compare_exchange_weak(known, a)) {
          }
          return;
        }
        if (encoder.slots() - counted > 1 << 16) {
          slots += encoder.slots() - counted;
          counted = encoder.slots();
        }
      }
      slots += encoder.slots() - counted;
      builder.put(c, encoder.take());
    }
  });
  error.rethrow();
  if (first_coincident < points.n) detail::throw_coincident(points, radii, first_coincident);
  PairListBuilder::check_slots(static_cast<double>(slots), points.n);
  return builder.build();
}

template <int D>
PairList search(const PointView<D>& points, const Radii& radii, SearchOptions options) {
  return options.method == SearchMethod::kd_tree ? search<D, detail::KdTree<D>>(points, radii)
                                                 : search<D, detail::CellSearch<D>>(points, radii);
}

}  // namespace

SearchMethod search_method(std::string_view name) {
  if (name == "cell_list") return SearchMethod::cell_list;
  if (name == "kd_tree") return SearchMethod::kd_tree;
  throw InputError(fmt::format("unknown neighbour search \"{}\"; valid: cell_list, kd_tree", name));
}

template <int D>
PairList find_pairs(PointView<D> points, double radius, SearchOptions options) {
  return search(points, Radii{radius, {}}, options);
}

template <int D>
PairList find_pairs(PointView<D> points, std::span<const double> radii, SearchOptions options) {
  if (radii.size() != static_cast<std::size_t>(points.n))
    throw InputError(
        fmt::format("{} radii for {} particles: each particle needs one", radii.size(), points.n));
  return search(points, points.n ? Radii{0, radii} : Radii{1, {}}, options);
}

template PairList find_pairs(PointView<1>, double, SearchOptions);
template PairList find_pairs(PointView<2>, double, SearchOptions);
template PairList find_pairs(PointView<3>, double, SearchOptions);
template PairList find_pairs(PointView<1>, std::span<const double>, SearchOptions);
template PairList find_pairs(PointView<2>, std::span<const double>, SearchOptions);
template PairList find_pairs(PointView<3>, std::span<const double>, SearchOptions);

}  // namespace taut
