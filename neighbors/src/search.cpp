#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <taut/core/error.hpp>
#include <taut/neighbors/search.hpp>
#include <utility>

#include "cell_search.hpp"
#include "kd_tree.hpp"
#include "neighbourhood.hpp"
#include "pair_list_builder.hpp"
#include "pair_test.hpp"
#include "parallel.hpp"
#include "point_check.hpp"
#include "slice_encoder.hpp"

namespace taut {
namespace {

using detail::Radii;

// Finds the pairs of slices, for one thread.
template <int D, class Searcher>
class SliceSearch {
 public:
  SliceSearch(const PointView<D>& points, const Radii& radii, const detail::Clusters<D>& clusters,
              const Searcher& searcher)
      : points_(points),
        radii_(radii),
        clusters_(clusters),
        searcher_(searcher),
        work_(points.n),
        pairs_(points, radii),
        encoder_(points.n) {}

  // Appends slices [begin, end) to `to`, as long as `proceed(slice)`. Returns a particle that lies on another
  // one, where it stopped, or none.
  template <class Proceed>
  Index run(Index begin, Index end, detail::EncodedSlices& to, Proceed&& proceed) {
    for (Index s = begin; s < end;) {
      const auto group = detail::group_from(clusters_, s, end);
      searcher_.find(group, work_, near_.slices);
      near_.gather(points_, radii_, clusters_, group);
      for (; s < group.end; ++s) {
        if (!proceed(s)) return no_particle;
        const auto slice = detail::make_slice(points_, radii_, s);
        if (const unsigned coincident = pairs_.run(slice, near_, group))
          return slice.first + std::countr_zero(coincident);
        encoder_.encode(s, pairs_.slices(), pairs_.matches(), pairs_.count(), to);
      }
    }
    return no_particle;
  }

 private:
  const PointView<D>& points_;
  const Radii& radii_;
  const detail::Clusters<D>& clusters_;
  const Searcher& searcher_;
  typename Searcher::Workspace work_;
  detail::Neighbourhood<D> near_;
  detail::PairTest<D> pairs_;
  detail::SliceEncoder encoder_;
};

// Makes room for the list, by a sample of its slices.
template <class Search>
void reserve_by_sample(Search&& search, Index slices, PairListBuilder& builder) {
  constexpr Index samples = 128;
  constexpr double margin = 1.2;
  if (slices < 32 * samples) return;
  detail::EncodedSlices sample;
  for (Index i = 0; i < samples; ++i) {
    const auto s = static_cast<Index>(std::int64_t{slices} * i / samples);
    search.run(s, s + 1, sample, [](Index) { return true; });
  }
  const double scale = margin * slices / samples;
  builder.reserve(scale * static_cast<double>(sample.mask.size()),
                  scale * static_cast<double>(sample.index.size()) / lanes);
}

// Chunks go to the threads in ascending order and a fault stops only those after it, so that the lowest fault
// is found whatever the number of threads.
template <int D, class Searcher>
PairList search(const PointView<D>& points, const Radii& radii) {
  detail::check_points(points);
  detail::check_radii(radii, points.n);
  PairListBuilder builder(points.n);
  if (points.n == 0) return builder.build();

  const detail::Clusters<D> clusters(points, radii);
  const Searcher searcher(points, radii, clusters);
  PairListBuilder::check_slots(searcher.least_pairs() / lanes, points.n);
  using Search = SliceSearch<D, Searcher>;
  reserve_by_sample(Search(points, radii, clusters, searcher), clusters.slices(), builder);

  // Looked at for every slice, hence away from what is written often.
  alignas(64) std::atomic<Index> first_coincident{points.n};
  alignas(64) std::atomic<Index> next_chunk{0};
  alignas(64) std::atomic<std::int64_t> slots{0};
  constexpr std::int64_t most_slots = std::numeric_limits<Index>::max();
  detail::ParallelError error;
#pragma omp parallel if (detail::worth_threads(points.n))
  error.guard([&] {
    Search search(points, radii, clusters, searcher);
    PairListBuilder::Queue queue(builder);
    for (Index c = next_chunk++; c < builder.chunks(); c = next_chunk++) {
      detail::EncodedSlices encoded = queue.take();
      std::int64_t counted = 0;
      const auto proceed = [&](Index s) {
        const auto now = static_cast<std::int64_t>(encoded.mask.size());
        if (now - counted > 1 << 16 && (slots += now - std::exchange(counted, now)) > most_slots)
          return false;
        return s * lanes <= first_coincident;
      };
      const Index coincident = search.run(builder.begin_slice(c), builder.end_slice(c), encoded, proceed);
      if (coincident != no_particle) {
        Index known = first_coincident;
        while (coincident < known && !first_coincident.compare_exchange_weak(known, coincident)) {
        }
      }
      slots += static_cast<std::int64_t>(encoded.mask.size()) - counted;
      if (first_coincident < std::min(points.n, builder.end_slice(c) * lanes) || slots > most_slots) return;
      queue.put(c, std::move(encoded));
    }
    queue.close();
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
