#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/pair_list_builder.hpp>
#include <type_traits>

namespace taut {

namespace {

template <class T>
void enlarge(AlignedArray<T>& array, std::int64_t used, std::int64_t size) {
  if (static_cast<std::int64_t>(array.size()) >= size) return;
  auto larger = AlignedArray<T>::for_overwrite(static_cast<std::size_t>(size));
  constexpr std::int64_t part = 1 << 16;
#pragma omp parallel for schedule(static) if (used > part)
  for (std::int64_t i = 0; i < used; i += part)
    std::copy_n(array.data() + i, std::min(part, used - i), larger.data() + i);
  array = std::move(larger);
}

}  // namespace

PairListBuilder::PairListBuilder(Index particles)
    : particles_(particles),
      slices_(static_cast<Index>(padded(static_cast<std::size_t>(particles)) / lanes)) {
  places_.resize(static_cast<std::size_t>((slices_ + chunk_slices - 1) / chunk_slices));
  list_.particles_ = particles_;
  list_.slice_begin_ = AlignedArray<std::int64_t>(static_cast<std::size_t>(slices_) + 1);
  list_.slice_gathered_ = AlignedArray<std::int64_t>(static_cast<std::size_t>(slices_));
}

void PairListBuilder::check_slots(double slots, double particles) {
  constexpr double most = std::numeric_limits<Index>::max();
  if (slots <= most) return;
  throw InputError(fmt::format(
      "the pair list of {:.0f} particles would need at least {:.3g} slots of eight pairs, and a 32-bit index "
      "counts {:.0f}: use a smaller radius (this one gives each at least {:.3g} neighbours) or fewer "
      "particles",
      particles, slots, most, slots * lanes / particles));
}

void PairListBuilder::reserve(double slots, double gathered) {
  constexpr double margin = 1.2;
  const auto make_room = [](auto& array, double size) {
    using Array = std::remove_reference_t<decltype(array)>;
    array = Array::for_overwrite(static_cast<std::size_t>(margin * size), static_cast<std::size_t>(size));
  };
  make_room(list_.first_, slots);
  make_room(list_.mask_, slots);
  make_room(list_.index_, gathered * lanes);
}

detail::EncodedSlices PairListBuilder::Queue::take() {
  if (spare_.empty()) return {};
  detail::EncodedSlices slices = std::move(spare_.back());
  spare_.pop_back();
  slices.clear();
  return slices;
}

void PairListBuilder::Queue::put(Index chunk, detail::EncodedSlices slices) {
  builder_.measure(chunk, slices);
  waiting_.emplace_back(chunk, std::move(slices));
  std::erase_if(waiting_, [&](auto& waiting) {
    const Place place = [&] {
      const std::lock_guard lock(builder_.mutex_);
      return builder_.places_[static_cast<std::size_t>(waiting.first)];
    }();
    if (place.slot < 0 || !builder_.fits(place)) return false;
    builder_.fill(waiting.second, waiting.first);
    spare_.push_back(std::move(waiting.second));
    return true;
  });
}

void PairListBuilder::Queue::close() {
  const std::lock_guard lock(builder_.mutex_);
  for (auto& waiting : waiting_) builder_.late_.push_back(std::move(waiting));
  waiting_.clear();
}

void PairListBuilder::measure(Index chunk, const detail::EncodedSlices& slices) {
  const std::lock_guard lock(mutex_);
  Place& own = places_[static_cast<std::size_t>(chunk)];
  own.slots = static_cast<std::int64_t>(slices.mask.size());
  own.blocks = static_cast<std::int64_t>(slices.index.size()) / lanes;
  pairs_ += slices.pairs;
  for (; placed_ < chunks() && places_[static_cast<std::size_t>(placed_)].slots >= 0; ++placed_) {
    Place& place = places_[static_cast<std::size_t>(placed_)];
    place.slot = slots_;
    place.block = blocks_;
    slots_ += place.slots;
    blocks_ += place.blocks;
  }
}

bool PairListBuilder::fits(const Place& place) const {
  return place.slot + place.slots <= list_.slots() &&
         (place.block + place.blocks) * lanes <= static_cast<std::int64_t>(list_.index_.size());
}

PairList PairListBuilder::build() {
  check_slots(static_cast<double>(slots_), particles_);
  const std::int64_t before = list_.slots(), index_before = static_cast<std::int64_t>(list_.index_.size());
  enlarge(list_.first_, before, slots_);
  enlarge(list_.mask_, before, slots_);
  enlarge(list_.index_, index_before, blocks_ * lanes);
  parallel_for(late_.size(), worth_threads(particles_), [&](std::size_t i) {
    const detail::EncodedSlices chunk = std::move(late_[i].second);
    fill(chunk, late_[i].first);
  });
  list_.first_.truncate(static_cast<std::size_t>(slots_));
  list_.mask_.truncate(static_cast<std::size_t>(slots_));
  list_.index_.truncate(static_cast<std::size_t>(blocks_) * lanes);
  list_.slice_begin_[static_cast<std::size_t>(slices_)] = slots_;
  list_.pairs_ = pairs_;
  return std::move(list_);
}

void PairListBuilder::fill(const detail::EncodedSlices& from, Index chunk) {
  std::int64_t slot = places_[static_cast<std::size_t>(chunk)].slot,
               block = places_[static_cast<std::size_t>(chunk)].block;
  Index s = begin_slice(chunk);
  std::copy(from.mask.begin(), from.mask.end(), list_.mask_.data() + slot);
  std::copy(from.index.begin(), from.index.end(), list_.index_.data() + block * lanes);
  const Index* first = from.first.data();
  for (const auto& slice : from.slices) {
    list_.slice_begin_[static_cast<std::size_t>(s)] = slot;
    std::copy_n(first, slice.contiguous, list_.first_.data() + slot);
    first += slice.contiguous;
    slot += slice.contiguous;
    list_.slice_gathered_[static_cast<std::size_t>(s)] = slot;
    for (Index g = 0; g < slice.gathered; ++g)
      list_.first_[static_cast<std::size_t>(slot++)] = static_cast<Index>(block++);
    ++s;
  }
}

}  // namespace taut
