#include "pair_list_builder.hpp"

#include <fmt/format.h>

#include <taut/core/error.hpp>

#include "lanes.hpp"
#include "parallel.hpp"

namespace taut {

PairListBuilder::PairListBuilder(Index particles)
    : particles_(particles),
      slices_(static_cast<Index>(padded(static_cast<std::size_t>(particles)) / lanes)) {
  chunks_.resize(static_cast<std::size_t>((slices_ + chunk_slices - 1) / chunk_slices));
}

void PairListBuilder::check_slots(double slots, double particles) {
  constexpr double most = std::numeric_limits<Index>::max();
  if (slots <= most) return;
  throw InputError(fmt::format(
      "the pair list of {:.0f} particles would need at least {:.3g} slots of eight pairs, and a 32-bit index "
      "counts "
      "{:.0f}: use a smaller radius (this one gives each at least {:.3g} neighbours) or fewer particles",
      particles, slots, most, slots * lanes / particles));
}

PairList PairListBuilder::build() {
  std::int64_t slots = 0, blocks = 0;
  std::vector<std::int64_t> slot_begin, block_begin;
  PairList list;
  list.particles_ = particles_;
  for (const detail::EncodedSlices& chunk : chunks_) {
    slot_begin.push_back(slots);
    block_begin.push_back(blocks);
    slots += chunk.slots;
    blocks += chunk.blocks;
    list.pairs_ += chunk.pairs;
  }
  check_slots(static_cast<double>(slots), particles_);

  list.slice_begin_ = AlignedArray<std::int64_t>(static_cast<std::size_t>(slices_) + 1);
  list.slice_gathered_ = AlignedArray<std::int64_t>(static_cast<std::size_t>(slices_));
  list.first_ = AlignedArray<Index>(static_cast<std::size_t>(slots));
  list.mask_ = AlignedArray<std::uint8_t>(static_cast<std::size_t>(slots));
  list.index_ = AlignedArray<Index>(static_cast<std::size_t>(blocks) * lanes);
  list.slice_begin_[static_cast<std::size_t>(slices_)] = slots;

  detail::ParallelError error;
#pragma omp parallel for schedule(static) if (detail::worth_threads(particles_))
  for (Index c = 0; c < chunks(); ++c)
    error.guard([&] {
      const detail::EncodedSlices chunk = std::move(chunks_[static_cast<std::size_t>(c)]);
      fill(chunk, begin_slice(c), slot_begin[static_cast<std::size_t>(c)],
           block_begin[static_cast<std::size_t>(c)], list);
    });
  error.rethrow();
  return list;
}

void PairListBuilder::fill(const detail::EncodedSlices& from, Index s, std::int64_t slot, std::int64_t block,
                           PairList& list) {
  std::vector<Index>
      gathered;  // slot by slot; one slot more than needed takes what the last stores leave over
  const Index* id = from.id.data();
  const std::uint8_t* mask = from.mask.data();
  for (const auto& slice : from.slices) {
    list.slice_begin_[static_cast<std::size_t>(s)] = slot;
    std::copy_n(id, slice.contiguous, list.first_.data() + slot);
    std::copy_n(mask, slice.contiguous, list.mask_.data() + slot);
    id += slice.contiguous;
    mask += slice.contiguous;
    slot += slice.contiguous;
    list.slice_gathered_[static_cast<std::size_t>(s)] = slot;

    if (gathered.size() < static_cast<std::size_t>(slice.gathered + 1) * lanes)
      gathered.resize(2 * static_cast<std::size_t>(slice.gathered + 1) * lanes);
    std::int64_t end[lanes] = {};
    Index* const out = gathered.data();
    for (std::int64_t i = 0; i < slice.loose; ++i) {
      const unsigned m = mask[i];
      for (int l = 0; l < lanes; ++l) {  // without branches: they could not be predicted
        out[end[l] * lanes + l] = id[i];
        end[l] += m >> l & 1;
      }
    }
    id += slice.loose;
    mask += slice.loose;

    std::uint8_t* const masks = list.mask_.data() + slot;
    std::fill_n(masks, slice.gathered, std::uint8_t{0xff});
    for (int l = 0; l < lanes; ++l)
      for (std::int64_t g = end[l]; g < slice.gathered; ++g) {
        out[g * lanes + l] = s * lanes + l;
        masks[g] = static_cast<std::uint8_t>(masks[g] & ~(1u << l));
      }
    std::copy_n(out, slice.gathered * lanes, list.index_.data() + block * lanes);
    for (std::int64_t g = 0; g < slice.gathered; ++g)
      list.first_[static_cast<std::size_t>(slot + g)] = static_cast<Index>(block + g);
    slot += slice.gathered;
    block += slice.gathered;
    ++s;
  }
}

}  // namespace taut
