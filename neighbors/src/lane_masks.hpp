#pragma once
// The pairs of one slice while they are being found: a byte a particle says which of the eight lanes pair
// with it.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <taut/core/fields.hpp>
#include <taut/core/types.hpp>
#include <vector>

#include "lanes.hpp"

namespace taut::detail {

// Two coarser levels tell which bytes may differ from zero: a bit for each granule of eight particles and a
// flag for each 64 granules. They sort the neighbours as they come: reading them back is ascending in the
// particle, at a cost that follows the pairs found.
class LaneMasks {
 public:
  explicit LaneMasks(Index particles)
      : memory_(static_cast<std::uint8_t*>(std::calloc(bytes_for(particles), 1))),
        granules_(bytes_for(particles) / 8 / 64 + 1),
        groups_(granules_.size() + sizeof(Bytes32)) {
    if (!memory_) throw std::bad_alloc();
  }

  // Lanes that pair with particle b. Bytes of particles that are not marked later must stay zero.
  std::uint8_t& operator[](Index b) { return memory_.get()[margin + b]; }
  const std::uint8_t* data() const { return memory_.get() + margin; }

  void mark(const Index* particles, std::size_t count) {
    std::size_t lowest = lowest_, highest = highest_;
    std::uint64_t* const granules = granules_.data();
    std::uint8_t* const groups = groups_.data();
    for (std::size_t i = 0; i < count; ++i) {
      const auto granule = static_cast<std::size_t>(particles[i]) / 8, group = granule / 64;
      groups[group] = 1;
      granules[group] |= std::uint64_t{1} << (granule % 64);
      lowest = std::min(lowest, group);
      highest = std::max(highest, group);
    }
    lowest_ = lowest;
    highest_ = highest;
  }

  // Calls visit(begin, end) for runs of marked granules, [begin, end) being particles, in
  // ascending order, and clears all. The bytes from begin - margin to end + margin may be read in the call.
  template <class Visit>
  void drain(Visit&& visit) {
    std::size_t begin = 0, end = 0;  // pending run, in granules
    const auto flush = [&] {
      if (begin == end) return;
      visit(static_cast<std::int64_t>(begin * 8), static_cast<std::int64_t>(end * 8));
      std::memset(memory_.get() + margin + begin * 8, 0, (end - begin) * 8);
    };
    for (std::size_t v = lowest_; v <= highest_; v += sizeof(Bytes32)) {
      std::uint32_t groups = nonzero(load_bytes(groups_.data() + v));
      if (!groups) continue;
      std::memset(groups_.data() + v, 0, sizeof(Bytes32));
      for (; groups; groups &= groups - 1) {
        const std::size_t g = v + static_cast<std::size_t>(std::countr_zero(groups));
        std::uint64_t bits = std::exchange(granules_[g], 0);
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

  static constexpr int margin = 64;
  // Runs this close, in granules, are one: the encoder's chunks would cover the gap anyway.
  static constexpr std::size_t closed_gap = 2;

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();
  static std::size_t bytes_for(Index particles) {
    return padded(static_cast<std::size_t>(particles)) + 2 * margin;
  }

  struct Free {
    void operator()(std::uint8_t* p) const { std::free(p); }
  };
  // calloc leaves pages that are never touched without memory: a thread pays for its own part of the cloud
  // only.
  std::unique_ptr<std::uint8_t[], Free> memory_;
  std::vector<std::uint64_t> granules_;
  std::vector<std::uint8_t> groups_;         // whether granules_[g] is not zero
  std::size_t lowest_ = none, highest_ = 0;  // groups in use
};

}  // namespace taut::detail
