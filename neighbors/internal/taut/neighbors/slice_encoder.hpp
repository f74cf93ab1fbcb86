#pragma once
// From the lane masks of a slice to its slots.

#include <cstdint>
#include <taut/base/types.hpp>
#include <taut/neighbors/encoded_slices.hpp>
#include <taut/neighbors/simd.hpp>
#include <vector>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

class SliceEncoder {
 public:
  explicit SliceEncoder(Index particles)
      : slices_(static_cast<Index>(padded(static_cast<std::size_t>(particles)) / lanes)) {}

  // Appends slice `own` to `out`, from `count` slices in ascending order and for each of their particles a
  // byte: the lanes that pair with it.
  void encode(Index own, const Index* slices, const std::uint64_t* matches, std::size_t count,
              EncodedSlices& out);

 private:
  void lay_out(const Index* slices, const std::uint64_t* matches, std::size_t count);
  bool pick_contiguous(EncodedSlices& out, Index& picked);
  std::size_t collect_loose();
  Index gather(Index own, std::size_t loose, EncodedSlices& out);

  Index slices_;
  // Of the runs of slices, each after a gap of one slice: the slice of each word, and the bytes, `margin`
  // more of them at both ends.
  static constexpr std::size_t margin = 128;
  std::size_t words_ = 0;
  std::vector<Index> slice_;
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint8_t> contiguous_;  // masks of the contiguous slots that begin at each byte
  std::vector<Index> loose_;              // particles to be gathered,
  std::vector<std::uint8_t> loose_mask_;  // and the lanes that pair with them
  std::vector<Index> dealt_;              // neighbours of each lane
};

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
