#include "slice_encoder.hpp"

#include "lanes.hpp"

namespace taut::detail {
namespace {

// From how many lanes on a contiguous slot is better than gathering its pairs. A step is about equally fast
// with any number from three to six (3D, 16 to 92 neighbours); fewer than five cost payload (a tenth more
// with four on curve-ordered clouds, a third with three), more make jittered lattices gather.
constexpr int worthwhile_lanes = 5;

inline std::uint64_t load_word(const std::uint8_t* p) {
  std::uint64_t w;
  std::memcpy(&w, p, sizeof w);
  return w;
}

// Byte l is all of bit l of the mask, in its place.
inline std::uint64_t diagonal(std::uint64_t mask) { return (mask * 0x0101010101010101) & 0x8040201008040201; }

}  // namespace

void SliceEncoder::end_slice() {
  const std::size_t before = slice_begin_;
  EncodedSlices::Slice slice;
  slice.contiguous = static_cast<std::int64_t>(entries_.count - before);
  slice.loose = static_cast<std::int64_t>(loose_.count);
  for (std::size_t i = before; i < entries_.count; ++i) sums_.pairs += mask_tables.count[entries_.mask[i]];

  std::int64_t per_lane[lanes] = {};
  for (std::size_t i = 0; i < loose_.count;) {
    std::uint64_t counters = 0;  // one byte a lane
    for (const std::size_t end = std::min(i + 255, loose_.count); i < end; ++i)
      counters += mask_tables.spread[loose_.mask[i]];
    for (int l = 0; l < lanes; ++l) per_lane[l] += counters >> (8 * l) & 0xff;
  }
  for (const std::int64_t n : per_lane) {
    slice.gathered = std::max(slice.gathered, n);
    sums_.pairs += n;
  }
  sums_.slots += slice.contiguous + slice.gathered;
  sums_.blocks += slice.gathered;
  sums_.slices.push_back(slice);

  entries_.reserve(loose_.count);
  std::copy_n(loose_.id.data(), loose_.count, entries_.id.data() + entries_.count);
  std::copy_n(loose_.mask.data(), loose_.count, entries_.mask.data() + entries_.count);
  entries_.count += loose_.count;
  slice_begin_ = entries_.count;
  loose_.count = 0;
}

// Lane l pairing with b is lane l of a contiguous slot whose lane 0 is at b - l. So the mask of the slot at f
// has its bit l from the byte of particle f + l: a diagonal of the bit matrix, taken for 32 values of f at
// once.
void SliceEncoder::encode_masks(std::uint8_t* data, std::int64_t begin, std::int64_t end) {
  constexpr std::int64_t chunk = sizeof(Bytes32);
  entries_.reserve(static_cast<std::size_t>(end - begin) + lanes);
  const std::size_t before = entries_.count;
  const auto within = [](std::int64_t bytes) {  // bits of a chunk that belong to the run
    return bytes >= chunk ? ~std::uint32_t{0} : (std::uint32_t{1} << bytes) - 1;
  };

  bool complete = true;
  for (std::int64_t f = begin - lanes; f < end; f += chunk) {
    Bytes32 slots = splat_bytes(0);
    for (int l = 0; l < lanes; ++l) slots = slots | (load_bytes(data + f + l) & splat_bytes(1 << l));
    std::uint32_t picked = at_least<worthwhile_lanes>(slots) & within(end - f);
    complete = complete && picked == (nonzero(slots) & within(end - f));
    std::uint8_t slot[chunk];
    std::memcpy(slot, &slots, sizeof slot);
    for (; picked; picked &= picked - 1) {
      const int place = std::countr_zero(picked);
      const bool addressable = f + place >= 0 && f + place + lanes <= padded_;
      entries_.put(f + place, slot[place], addressable);
      complete = complete && addressable;
    }
  }
  const auto clear = [&] { std::memset(data + begin, 0, static_cast<std::size_t>(end - begin)); };
  if (complete) return clear();

  for (std::size_t i = before; i < entries_.count; ++i) {
    std::uint8_t* at = data + entries_.id[i];
    const std::uint64_t word = load_word(at) & ~diagonal(entries_.mask[i]);
    std::memcpy(at, &word, sizeof word);
  }
  loose_.reserve(static_cast<std::size_t>(end - begin));
  for (std::int64_t b = begin; b < end; b += chunk)
    for (std::uint32_t left = nonzero(load_bytes(data + b)) & within(end - b); left; left &= left - 1) {
      const int place = std::countr_zero(left);
      loose_.put(b + place, data[b + place], true);
    }
  clear();
}

void SliceEncoder::encode_diagonals(const std::uint8_t* masks, std::int64_t begin, std::int64_t end) {
  if (begin >= end) return;
  const auto most = static_cast<std::size_t>(end - begin) + lanes;
  entries_.reserve(most);
  loose_.reserve(most);
  Entries::Writer slots(entries_), loose(loose_);
  bool complete = true;
  for (std::int64_t f = begin; f < end; ++f) {
    const bool worthwhile = mask_tables.count[masks[f]] >= worthwhile_lanes;
    slots.put(f, masks[f], worthwhile);
    complete &= worthwhile || masks[f] == 0;
  }
  if (complete) return;

  std::uint64_t pending = 0;  // byte i: lanes that pair with particle f + i but belong to no slot
  for (std::int64_t f = begin; f < end; ++f) {
    const bool worthwhile = mask_tables.count[masks[f]] >= worthwhile_lanes;
    pending |= diagonal(worthwhile ? 0 : masks[f]);
    loose.put(f, pending & 0xff, (pending & 0xff) != 0);
    pending >>= 8;
  }
  for (std::int64_t b = end; pending; ++b, pending >>= 8) loose.put(b, pending & 0xff, (pending & 0xff) != 0);
}

EncodedSlices SliceEncoder::take() {
  EncodedSlices result = std::move(sums_);
  result.id.assign(entries_.id.data(), entries_.id.data() + entries_.count);
  result.mask.assign(entries_.mask.data(), entries_.mask.data() + entries_.count);
  sums_ = {};
  entries_.count = slice_begin_ = 0;
  return result;
}

}  // namespace taut::detail
