#pragma once
// A set of slices that is filled in any order and read back in ascending runs.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <taut/core/types.hpp>
#include <utility>
#include <vector>

#include "lanes.hpp"

namespace taut::detail {

// A bit for each slice and a flag for each 64 of them that tells which words may differ from zero: reading
// back sorts at a cost that follows the members, not the range.
class SliceSet {
 public:
  explicit SliceSet(Index particles)
      : slices_(padded(static_cast<std::size_t>(particles)) / lanes / 64 + 1),
        groups_(slices_.size() + sizeof(Bytes32)) {}

  void insert(const Index* slices, std::size_t count) {
    std::size_t lowest = lowest_, highest = highest_;
    std::uint64_t* const words = slices_.data();
    std::uint8_t* const groups = groups_.data();
    for (std::size_t i = 0; i < count; ++i) {
      const auto slice = static_cast<std::size_t>(slices[i]), group = slice / 64;
      groups[group] = 1;
      words[group] |= std::uint64_t{1} << (slice % 64);
      lowest = std::min(lowest, group);
      highest = std::max(highest, group);
    }
    lowest_ = lowest;
    highest_ = highest;
  }

  // Calls visit(begin, end) for the runs of slices in the set, in ascending order, and empties it. Runs with
  // at most `closed_gap` slices between them count as one.
  template <class Visit>
  void drain(std::size_t closed_gap, Visit&& visit) {
    std::size_t begin = 0, end = 0;  // pending run
    const auto flush = [&] {
      if (begin < end) visit(static_cast<Index>(begin), static_cast<Index>(end));
    };
    for (std::size_t v = lowest_; v <= highest_; v += sizeof(Bytes32)) {
      std::uint32_t groups = nonzero(load_bytes(groups_.data() + v));
      if (!groups) continue;
      std::memset(groups_.data() + v, 0, sizeof(Bytes32));
      for (; groups; groups &= groups - 1) {
        const std::size_t g = v + static_cast<std::size_t>(std::countr_zero(groups));
        std::uint64_t bits = std::exchange(slices_[g], 0);
        while (bits) {
          const int first = std::countr_zero(bits);
          const int length = std::countr_one(bits >> first);
          const std::size_t start = g * 64 + static_cast<std::size_t>(first);
          if (begin == end || start > end + closed_gap) {
            flush();
            begin = start;
          }
          end = start + static_cast<std::size_t>(length);
          bits &= first + length == 64 ? 0 : ~std::uint64_t{0} << (first + length);
        }
      }
    }
    flush();
    lowest_ = none;
    highest_ = 0;
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  std::vector<std::uint64_t> slices_;
  std::vector<std::uint8_t> groups_;         // whether slices_[g] is not zero
  std::size_t lowest_ = none, highest_ = 0;  // groups in use
};

}  // namespace taut::detail
