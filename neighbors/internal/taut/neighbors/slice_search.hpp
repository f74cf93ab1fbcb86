#pragma once
// The pair list of all slices, with what a searcher (cells, or a tree) finds near them.

#include <algorithm>
#include <atomic>
#include <bit>
#include <limits>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/neighbourhood.hpp>
#include <taut/neighbors/pair_list_builder.hpp>
#include <taut/neighbors/pair_test.hpp>
#include <taut/neighbors/point_check.hpp>
#include <taut/neighbors/slice_encoder.hpp>
#include <utility>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

// Finds the pairs of slices, for one thread.
template <int D, class Searcher>
class SliceSearch {
 public:
  SliceSearch(const PointView<D>& points, const Radii& radii, const Clusters<D>& clusters,
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
  Index run(Index begin, Index end, EncodedSlices& to, Proceed&& proceed) {
    for (Index s = begin; s < end;) {
      const auto group = group_from(points_, radii_, clusters_, s, end);
      searcher_.find(group, work_, near_.slices);
      near_.gather(points_, radii_, group);
      for (; s < group.end; ++s) {
        if (!proceed(s)) return no_particle;
        const auto slice = make_slice(points_, radii_, s);
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
  const Clusters<D>& clusters_;
  const Searcher& searcher_;
  typename Searcher::Workspace work_;
  Neighbourhood<D> near_;
  PairTest<D> pairs_;
  SliceEncoder encoder_;
};

// Makes room for the list, by a sample of its slices.
template <class Search>
void reserve_by_sample(Search&& search, Index slices, PairListBuilder& builder) {
  constexpr Index samples = 128;
  if (slices < 32 * samples) return;
  EncodedSlices sample;
  for (Index i = 0; i < samples; ++i) {
    const auto s = static_cast<Index>(std::int64_t{slices} * i / samples);
    search.run(s, s + 1, sample, [](Index) { return true; });
  }
  const double scale = static_cast<double>(slices) / samples;
  builder.reserve(scale * static_cast<double>(sample.mask.size()),
                  scale * static_cast<double>(sample.index.size()) / lanes);
}

// Chunks go to the threads in ascending order and a fault stops only those after it, so that the lowest fault
// is found whatever the number of threads.
template <int D, class Searcher>
PairList search_with(const PointView<D>& points, const Radii& radii) {
  check_points(points);
  check_radii(radii, points.n);
  if (points.n == 0) return PairListBuilder(0).build();

  Clusters<D> clusters(points, radii);
  const Searcher searcher(points, radii, clusters);
  clusters.drop_whole();
  PairListBuilder::check_slots(searcher.least_pairs() / lanes, points.n);
  PairListBuilder builder(points.n);
  using Search = SliceSearch<D, Searcher>;
  reserve_by_sample(Search(points, radii, clusters, searcher), clusters.slices(), builder);

  // Looked at for every slice, hence away from what is written often.
  alignas(64) std::atomic<Index> first_coincident{points.n};
  alignas(64) std::atomic<Index> next_chunk{0};
  alignas(64) std::atomic<std::int64_t> slots{0};
  constexpr std::int64_t most_slots = std::numeric_limits<Index>::max();
  on_threads(worth_threads(points.n), [&] {
    Search search(points, radii, clusters, searcher);
    PairListBuilder::Queue queue(builder);
    for (Index c = next_chunk++; c < builder.chunks(); c = next_chunk++) {
      EncodedSlices encoded = queue.take();
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
  if (first_coincident < points.n) throw_coincident(points, radii, first_coincident);
  PairListBuilder::check_slots(static_cast<double>(slots), points.n);
  return builder.build();
}

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
