#pragma once
/// \file
/// Sliced pair lists: the neighbours of eight consecutive particles, slot by slot.

#include <cstdint>
#include <functional>
#include <taut/base/fields.hpp>
#include <taut/base/types.hpp>

namespace taut {

/// Directed pairs (a, b), b within the support of a, in slices of `lanes` consecutive particles (the layout
/// of SELL-C-sigma sparse matrices: Kreutzer et al., SIAM J. Sci. Comput. 36, 2014). A slice owns a range of
/// slots; a slot holds at most one neighbour for each of the slice's particles. Slots come in two kinds, the
/// contiguous ones of a slice first:
///  - contiguous: lane l pairs with particle `first + l`, so a field is loaded, not gathered;
///  - gathered: lane l pairs with its own entry of an index block.
/// A lane without a pair in a slot has its bit of `mask` unset; its index is then still a valid particle
/// (padding included), and payloads are zero there, so that loops need no branch. The order of the slots
/// depends on the points alone, never on the number of threads.
class PairList {
 public:
  Index particles() const { return particles_; }
  /// Directed pairs, padding not counted. A particle is not its own neighbour.
  std::int64_t pairs() const { return pairs_; }
  Index slices() const { return static_cast<Index>(padded(particles_) / lanes); }
  std::int64_t slots() const { return static_cast<std::int64_t>(first_.size()); }

  /// Slots of slice s: [begin(s), begin(s + 1)); those before `gathered(s)` are contiguous.
  std::int64_t begin(Index s) const { return slice_begin_[s]; }
  std::int64_t gathered(Index s) const { return slice_gathered_[s]; }
  /// Contiguous slot: the neighbour of lane 0; lane l pairs with first(k) + l, always within the padded
  /// arrays. Gathered slot: the number of its index block.
  Index first(std::int64_t k) const { return first_[k]; }
  /// The eight neighbour indices of a gathered slot.
  const Index* block(std::int64_t k) const { return indices(first_[k]); }
  /// Those of an index block, by its number.
  const Index* indices(Index number) const {
    return index_.data() + static_cast<std::int64_t>(number) * lanes;
  }
  /// Bit l is set where lane l has a pair in slot k.
  std::uint8_t mask(std::int64_t k) const { return mask_[k]; }
  bool is_contiguous(Index s, std::int64_t k) const { return k < gathered(s); }
  /// Fraction of the slots that are loaded contiguously.
  double contiguous_fraction() const;

  /// Calls f(b, k, lane) for each neighbour b of particle a, in slot order; for set-up code and tests.
  template <class F>
  void for_each(Index a, F&& f) const {
    const Index s = a / lanes;
    const int lane = a % lanes;
    for (std::int64_t k = begin(s); k < begin(s + 1); ++k) {
      if (!(mask_[k] >> lane & 1)) continue;
      f(k < gathered(s) ? first_[k] + lane : block(k)[lane], k, lane);
    }
  }

  /// The slot that holds the pair (a, b), or -1: where payload of the reverse of a pair is kept. Scans the
  /// slots of a.
  std::int64_t find(Index a, Index b) const;

  std::size_t bytes() const {
    return slice_begin_.bytes() + slice_gathered_.bytes() + first_.bytes() + mask_.bytes() + index_.bytes();
  }

 private:
  friend class PairListBuilder;
  friend void filter_pairs(PairList& list, const std::function<bool(Index, Index)>& keep);
  Index particles_ = 0;
  std::int64_t pairs_ = 0;
  AlignedArray<std::int64_t> slice_begin_;     // slices + 1
  AlignedArray<std::int64_t> slice_gathered_;  // slices
  AlignedArray<Index> first_;                  // slots
  AlignedArray<std::uint8_t> mask_;            // slots
  AlignedArray<Index> index_;                  // lanes a gathered slot
};

/// Leaves the pairs (a, b) for which `keep(a, b)` holds, which must equal keep(b, a) and is called from many
/// threads. The order of those that stay does not change; slots that lose all their pairs go. A list of which
/// all is kept stays as it was, to the last bit.
void filter_pairs(PairList& list, const std::function<bool(Index a, Index b)>& keep);

}  // namespace taut
