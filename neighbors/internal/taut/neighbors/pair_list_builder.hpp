#pragma once
#include <mutex>
#include <taut/neighbors/encoded_slices.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <vector>

namespace taut {

// Lays out a pair list: the slices arrive in chunks, from any thread and nearly in order. A chunk is copied
// to its final place as soon as all before it have been measured, while it is still in cache; the arrays have
// room for more than is expected, whose pages take no memory until they are written.
class PairListBuilder {
 public:
  static constexpr Index chunk_slices = 64;

  explicit PairListBuilder(Index particles);
  Index chunks() const { return static_cast<Index>(places_.size()); }
  Index begin_slice(Index chunk) const { return chunk * chunk_slices; }
  Index end_slice(Index chunk) const { return std::min((chunk + 1) * chunk_slices, slices_); }

  // Makes room for so many slots, gathered ones among them, and a few more. What does not fit is moved at the
  // end.
  void reserve(double slots, double gathered);

  // The chunks of one thread, while they wait for their places.
  class Queue {
   public:
    explicit Queue(PairListBuilder& builder) : builder_(builder) {}
    // An empty chunk to be filled.
    detail::EncodedSlices take();
    void put(Index chunk, detail::EncodedSlices slices);
    // To be called after the last chunk.
    void close();

   private:
    PairListBuilder& builder_;
    std::vector<std::pair<Index, detail::EncodedSlices>> waiting_;
    std::vector<detail::EncodedSlices> spare_;
  };

  // To be called once, after all queues are closed.
  PairList build();

  // \throws InputError where a list of so many slots cannot be addressed.
  static void check_slots(double slots, double particles);

 private:
  struct Place {
    std::int64_t slots = -1, blocks = 0;  // of the chunk, once measured
    std::int64_t slot = -1, block = 0;    // where it begins, once known
  };
  void measure(Index chunk, const detail::EncodedSlices& slices);
  bool fits(const Place& place) const;
  void fill(const detail::EncodedSlices& from, Index chunk);

  Index particles_, slices_;
  std::mutex mutex_;
  std::vector<Place> places_;
  Index placed_ = 0;  // chunks whose place is known
  std::int64_t slots_ = 0, blocks_ = 0, pairs_ = 0;
  std::vector<std::pair<Index, detail::EncodedSlices>> late_;
  PairList list_;
};

}  // namespace taut
