#include <bit>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/pair_list.hpp>

namespace taut {

void filter_pairs(PairList& list, const std::function<bool(Index, Index)>& keep) {
  if (!keep) throw InputError("filter_pairs: the predicate is an empty function");
  std::int64_t pairs = 0, empty = 0;
  ParallelError error;
#pragma omp parallel for schedule(dynamic, 64) reduction(+ : pairs, empty) \
    if (worth_threads(list.particles()))
  for (Index s = 0; s < list.slices(); ++s)
    error.guard([&] {
      for (std::int64_t k = list.begin(s); k < list.begin(s + 1); ++k) {
        std::uint8_t& mask = list.mask_[static_cast<std::size_t>(k)];
        for (int l = 0; l < lanes; ++l) {
          if (!(mask >> l & 1)) continue;
          const Index b = list.is_contiguous(s, k) ? list.first(k) + l : list.block(k)[l];
          if (!keep(s * lanes + l, b)) mask = static_cast<std::uint8_t>(mask & ~(1u << l));
        }
        pairs += std::popcount(mask);
        empty += mask == 0;
      }
    });
  error.rethrow();
  list.pairs_ = pairs;
  if (empty == 0) return;

  std::int64_t from = 0, to = 0;
  for (Index s = 0; s < list.slices(); ++s) {
    const std::int64_t gathered = list.gathered(s), end = list.begin(s + 1);
    list.slice_begin_[static_cast<std::size_t>(s)] = to;
    const auto move_until = [&](std::int64_t last) {
      for (; from < last; ++from) {
        if (list.mask(from) == 0) continue;
        list.first_[static_cast<std::size_t>(to)] = list.first(from);
        list.mask_[static_cast<std::size_t>(to)] = list.mask(from);
        ++to;
      }
    };
    move_until(gathered);
    list.slice_gathered_[static_cast<std::size_t>(s)] = to;
    move_until(end);
  }
  list.slice_begin_[static_cast<std::size_t>(list.slices())] = to;
  list.first_.truncate(static_cast<std::size_t>(to));
  list.mask_.truncate(static_cast<std::size_t>(to));
}

}  // namespace taut
