#pragma once
// Slots of slices, before they take their place in a pair list.

#include <cstdint>
#include <taut/base/types.hpp>
#include <taut/neighbors/buffer.hpp>
#include <vector>

namespace taut::detail {

// Consecutive slices. A slice's slots: first the contiguous ones, then the gathered.
struct EncodedSlices {
  struct Slice {
    Index contiguous = 0, gathered = 0;
  };
  std::vector<Slice> slices;
  Buffer<Index> first;        // neighbour of lane 0, contiguous slots only
  Buffer<std::uint8_t> mask;  // all slots
  Buffer<Index> index;        // the blocks of gathered slots
  std::int64_t pairs = 0;

  // Keeps the memory.
  void clear() {
    slices.clear();
    first.clear();
    mask.clear();
    index.clear();
    pairs = 0;
  }
};

}  // namespace taut::detail
