#pragma once
// From the lane masks of a slice to what its slots will hold.

#include <cstdint>
#include <vector>

#include "lane_masks.hpp"

namespace taut::detail {

// Consecutive slices in compressed form. A slice's entries: first its contiguous slots (the neighbour of lane
// 0 and the mask), then the particles to be gathered, ascending, each with the mask of the lanes that pair
// with it.
struct EncodedSlices {
  struct Slice {
    std::int64_t contiguous = 0;  // entries that are contiguous slots
    std::int64_t loose = 0;       // entries to be gathered
    std::int64_t gathered = 0;    // slots that these fill: the most any lane has
  };
  std::vector<Slice> slices;
  std::vector<Index> id;
  std::vector<std::uint8_t> mask;
  std::int64_t pairs = 0, slots = 0, blocks = 0;  // sums: directed pairs, slots, gathered slots
};

class SliceEncoder {
 public:
  explicit SliceEncoder(Index particles)
      : padded_(static_cast<std::int64_t>(padded(static_cast<std::size_t>(particles)))) {}

  // Slots of the next slice, in any number of parts that come in ascending order of the particles with a
  // slice between them at least; `end_slice` ends it. From a byte for each particle b in [begin, end), the
  // lanes that pair with it; they are cleared. Up to LaneMasks::margin bytes around them are read.
  void encode_masks(std::uint8_t* masks, std::int64_t begin, std::int64_t end);
  // From a byte for each contiguous slot whose lane 0 pairs with f in [begin, end). All can be addressed.
  void encode_diagonals(const std::uint8_t* masks, std::int64_t begin, std::int64_t end);
  void end_slice();
  // All since the last take.
  EncodedSlices take();
  std::int64_t slots() const { return sums_.slots; }

 private:
  struct Entries {
    std::vector<Index> id;
    std::vector<std::uint8_t> mask;
    std::size_t count = 0;
    void reserve(std::size_t more) {
      if (id.size() < count + more) {
        id.resize(2 * (count + more));
        mask.resize(id.size());
      }
    }
    void put(std::int64_t i, std::uint64_t m, bool keep) {
      id[count] = static_cast<Index>(i);
      mask[count] = static_cast<std::uint8_t>(m);
      count += keep;
    }
    // Puts entries for which there is room, itself in registers: the bytes that it stores could else be any
    // of an Entries' own.
    struct Writer {
      explicit Writer(Entries& e) : entries(e), id(e.id.data()), mask(e.mask.data()), count(e.count) {}
      ~Writer() { entries.count = count; }
      void put(std::int64_t i, std::uint64_t m, bool keep) {
        id[count] = static_cast<Index>(i);
        mask[count] = static_cast<std::uint8_t>(m);
        count += keep;
      }
      Entries& entries;
      Index* id;
      std::uint8_t* mask;
      std::size_t count;
    };
  };

  std::int64_t padded_;
  Entries entries_, loose_;
  std::size_t slice_begin_ = 0;  // in entries_
  EncodedSlices sums_;
};

}  // namespace taut::detail
