#pragma once
#include <taut/neighbors/pair_list.hpp>
#include <vector>

#include "slice_encoder.hpp"

namespace taut {

// Lays out a pair list: the slices arrive in compressed chunks, in any order and from any thread; `build`
// then knows every size and fills the arrays in parallel.
class PairListBuilder {
 public:
  static constexpr Index chunk_slices = 256;

  explicit PairListBuilder(Index particles);
  Index chunks() const { return static_cast<Index>(chunks_.size()); }
  Index begin_slice(Index chunk) const { return chunk * chunk_slices; }
  Index end_slice(Index chunk) const { return std::min((chunk + 1) * chunk_slices, slices_); }
  // Different chunks may be put at the same time.
  void put(Index chunk, detail::EncodedSlices slices) {
    chunks_[static_cast<std::size_t>(chunk)] = std::move(slices);
  }
  // Frees the chunks as it goes. To be called once.
  PairList build();

  // \throws InputError where a list of so many slots cannot be addressed.
  static void check_slots(double slots, double particles);

 private:
  static void fill(const detail::EncodedSlices& from, Index slice, std::int64_t slot, std::int64_t block,
                   PairList& list);

  Index particles_, slices_;
  std::vector<detail::EncodedSlices> chunks_;
};

}  // namespace taut
