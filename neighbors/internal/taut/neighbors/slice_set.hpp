#pragma once
// A set of slices that is filled in any order and read back in ascending order.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <taut/base/types.hpp>
#include <taut/neighbors/lanes.hpp>
#include <utility>
#include <vector>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

// A bit for each slice and a flag for each 64 of them that tells which words may differ from zero: reading
// back sorts at a cost that follows the members, not the range.
class SliceSet {
 public:
  explicit SliceSet(Index particles)
      : slices_(padded(static_cast<std::size_t>(particles)) / lanes / 64 + 1),
        groups_(slices_.size() + sizeof(Bytes)) {}

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

  // Appends the slices of the set in ascending order, and empties it.
  void drain(std::vector<Index>& to) {
    for (std::size_t v = lowest_; v <= highest_; v += sizeof(Bytes)) {
      std::uint64_t groups = nonzero(load_bytes(groups_.data() + v));
      if (!groups) continue;
      std::memset(groups_.data() + v, 0, sizeof(Bytes));
      for (; groups; groups &= groups - 1) {
        const std::size_t g = v + static_cast<std::size_t>(std::countr_zero(groups));
        for (std::uint64_t bits = std::exchange(slices_[g], 0); bits; bits &= bits - 1)
          to.push_back(static_cast<Index>(g * 64 + static_cast<std::size_t>(std::countr_zero(bits))));
      }
    }
    lowest_ = none;
    highest_ = 0;
  }

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  std::vector<std::uint64_t> slices_;
  std::vector<std::uint8_t> groups_;         // whether slices_[g] is not zero
  std::size_t lowest_ = none, highest_ = 0;  // groups in use
};

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
