#pragma once
// The pairs of one slice while they are being found: a byte a particle says which of the eight lanes pair
// with it.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <taut/core/fields.hpp>
#include <taut/core/types.hpp>
#include <vector>

namespace taut::detail {

// A bitmap of two levels over granules of eight particles tells which bytes may differ from zero. It sorts
// the neighbours as they come: reading it back is ascending in the particle, at a cost that follows the pairs
// found.
class LaneMasks {
 public:
  explicit LaneMasks(Index particles)
      : memory_(static_cast<std::uint8_t*>(std::calloc(bytes_for(particles), 1))),
        granules_(bytes_for(particles) / 8 / 64 + 1),
        words_(granules_.size() / 64 + 1),
        lowest_(words_.size()) {
    if (!memory_) throw std::bad_alloc();
  }

  // Lanes that pair with particle b. Bytes of particles that are not marked later must stay zero.
  std::uint8_t& operator[](Index b) { return memory_.get()[margin + b]; }
  const std::uint8_t* data() const { return memory_.get() + margin; }

  void mark(Index b) {
    const std::size_t granule = static_cast<std::size_t>(b) / 8, word = granule / 64;
    if (!granules_[word]) {
      words_[word / 64] |= std::uint64_t{1} << (word % 64);
      lowest_ = std::min(lowest_, word / 64);
      highest_ = std::max(highest_, word / 64);
    }
    granules_[word] |= std::uint64_t{1} << (granule % 64);
  }

  // Calls visit(begin, end) for the maximal runs of marked granules, [begin, end) being particles, in
  // ascending order, and clears all. The bytes from begin - margin to end + margin may be read in the call.
  template <class Visit>
  void drain(Visit&& visit) {
    std::size_t begin = 0, end = 0;  // pending run, in granules
    const auto flush = [&] {
      if (begin == end) return;
      visit(static_cast<std::int64_t>(begin * 8), static_cast<std::int64_t>(end * 8));
      std::memset(memory_.get() + margin + begin * 8, 0, (end - begin) * 8);
    };
    for (std::size_t v = lowest_; v <= highest_ && v < words_.size(); ++v) {
      for (std::uint64_t words = std::exchange(words_[v], 0); words; words &= words - 1) {
        const std::size_t w = v * 64 + static_cast<std::size_t>(std::countr_zero(words));
        std::uint64_t bits = std::exchange(granules_[w], 0);
        while (bits) {
          const int first = std::countr_zero(bits);
          const int length = std::countr_one(bits >> first);
          const std::size_t start = w * 64 + static_cast<std::size_t>(first);
          if (start != end) {
            flush();
            begin = start;
          }
          end = start + static_cast<std::size_t>(length);
          bits &= first + length == 64 ? 0 : ~std::uint64_t{0} << (first + length);
        }
      }
    }
    flush();
    lowest_ = words_.size();
    highest_ = 0;
  }

  static constexpr int margin = 64;

 private:
  static std::size_t bytes_for(Index particles) {
    return padded(static_cast<std::size_t>(particles)) + 2 * margin;
  }

  struct Free {
    void operator()(std::uint8_t* p) const { std::free(p); }
  };
  // calloc leaves pages that are never touched without memory: a thread pays for its own part of the cloud
  // only.
  std::unique_ptr<std::uint8_t[], Free> memory_;
  std::vector<std::uint64_t> granules_;  // bit g: granule g is marked
  std::vector<std::uint64_t> words_;     // bit w: granules_[w] is not zero
  std::size_t lowest_, highest_ = 0;     // range of words_ in use
};

}  // namespace taut::detail
