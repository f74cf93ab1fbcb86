#include <omp.h>

#include <algorithm>
#include <array>
#include <taut/neighbors/sort_by_key.hpp>
#include <vector>

namespace taut::detail {
namespace {

constexpr int digit_bits = 11;
constexpr int digits = 1 << digit_bits;
using Histogram = std::array<std::uint32_t, digits>;

}  // namespace

// Radix sort, least significant digit first. Each thread has a contiguous block; being stable, the result
// does not depend on the number of blocks.
template <class Key>
std::unique_ptr<Index[]> sort_by_key(std::span<Key> keys, int bits) {
  const auto n = static_cast<std::int64_t>(keys.size());
  auto order = std::make_unique_for_overwrite<Index[]>(keys.size());
  auto other_order = std::make_unique_for_overwrite<Index[]>(keys.size());
  auto other = std::make_unique_for_overwrite<Key[]>(keys.size());
  const int blocks = static_cast<int>(std::clamp<std::int64_t>(n / 4096, 1, omp_get_max_threads()));
  std::vector<Histogram> counts(static_cast<std::size_t>(blocks));
  const auto block_begin = [&](int b) { return n * b / blocks; };

  Key* from = keys.data();
  Key* to = other.get();
#pragma omp parallel for schedule(static) if (blocks > 1)
  for (std::int64_t i = 0; i < n; ++i) order[i] = static_cast<Index>(i);

  for (int shift = 0; shift < bits; shift += digit_bits) {
    const auto digit = [shift](Key key) { return static_cast<std::size_t>(key >> shift) % digits; };
#pragma omp parallel for schedule(static) num_threads(blocks) if (blocks > 1)
    for (int b = 0; b < blocks; ++b) {
      Histogram& count = counts[static_cast<std::size_t>(b)];
      count.fill(0);
      for (std::int64_t i = block_begin(b); i < block_begin(b + 1); ++i) ++count[digit(from[i])];
    }
    std::uint32_t total = 0;
    for (std::size_t d = 0; d < digits; ++d)
      for (Histogram& count : counts) {
        const std::uint32_t here = count[d];
        count[d] = total;
        total += here;
      }
#pragma omp parallel for schedule(static) num_threads(blocks) if (blocks > 1)
    for (int b = 0; b < blocks; ++b) {
      Histogram& place = counts[static_cast<std::size_t>(b)];
      for (std::int64_t i = block_begin(b); i < block_begin(b + 1); ++i) {
        const std::uint32_t at = place[digit(from[i])]++;
        to[at] = from[i];
        other_order[at] = order[i];
      }
    }
    std::swap(from, to);
    order.swap(other_order);
  }
  if (from != keys.data()) std::copy_n(from, keys.size(), keys.data());
  return order;
}

template std::unique_ptr<Index[]> sort_by_key(std::span<std::uint32_t>, int);
template std::unique_ptr<Index[]> sort_by_key(std::span<std::uint64_t>, int);

}  // namespace taut::detail
