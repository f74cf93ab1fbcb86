#include <algorithm>
#include <bit>
#include <cstring>
#include <taut/neighbors/lanes.hpp>
#include <taut/neighbors/slice_encoder.hpp>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {
namespace {

// From how many lanes on a contiguous slot is better than gathering its pairs. A step is about equally fast
// with any number from three to six (3D, 16 to 92 neighbours); fewer than five cost payload (a tenth more
// with four on curve-ordered clouds, a third with three), more make jittered lattices gather.
constexpr int worthwhile_lanes = 5;

constexpr std::size_t chunk = bytes;

template <class T>
void reserve(std::vector<T>& v, std::size_t size) {
  if (v.size() < size) v.resize(2 * size);
}

}  // namespace

void SliceEncoder::encode(Index own, const Index* slices, const std::uint64_t* matches, std::size_t count,
                          EncodedSlices& out) {
  EncodedSlices::Slice slice;
  lay_out(slices, matches, count);
  if (!pick_contiguous(out, slice.contiguous)) slice.gathered = gather(own, collect_loose(), out);
  out.slices.push_back(slice);
}

void SliceEncoder::lay_out(const Index* slices, const std::uint64_t* matches, std::size_t count) {
  const std::size_t most = 2 * count;
  reserve(slice_, most + chunk / lanes);
  if (bytes_.size() < most * lanes + 2 * margin) {
    bytes_.resize(2 * (most * lanes + 2 * margin));
    contiguous_.resize(bytes_.size());
  }
  Index* const to = slice_.data();
  std::uint8_t* const data = bytes_.data() + margin;
  std::size_t w = 0;
  Index before = -2;
  for (std::size_t i = 0; i < count; ++i) {
    const Index s = slices[i];
    // The gap, to be overwritten where there is none.
    to[w] = s - 1;
    std::memset(data + w * lanes, 0, lanes);
    w += s != before + 1;
    to[w] = s;
    std::memcpy(data + w * lanes, matches + i, lanes);
    ++w;
    before = s;
  }
  words_ = w;
  std::memset(data + w * lanes, 0, margin);
}

// Lane l pairing with b is lane l of a contiguous slot whose lane 0 is at b - l. So the mask of the slot at f
// has its bit l from the byte of particle f + l: a diagonal of the bit matrix, taken for a pack of values
// of f at once. Returns whether no pairs are left over.
bool SliceEncoder::pick_contiguous(EncodedSlices& out, Index& count) {
  const std::size_t length = words_ * lanes;
  const std::uint8_t* const data = bytes_.data() + margin;
  std::uint8_t* const contiguous = contiguous_.data() + margin;
  const Index* const slice = slice_.data();
  Index* first = out.first.room(length + margin);
  std::uint8_t* mask = out.mask.room(length + margin);
  std::uint8_t* const before = mask;
  const bool at_begin = words_ > 0 && slice_[0]<0, at_end = words_> 0 && slice_[words_ - 1] == slices_ - 1;

  bool complete = true;
  for (std::size_t p = 0; p < length; p += chunk) {
    Bytes slots = splat_bytes(0);
#pragma GCC unroll 8
    for (int l = 0; l < lanes; ++l) slots = slots | (load_bytes(data + p + l) & splat_bytes(1 << l));
    Bytes worthwhile = with_bits<worthwhile_lanes>(slots);
    store_bytes(worthwhile, contiguous + p);
    // Slots that reach beyond the particles cannot be addressed.
    const bool begins = at_begin && p == 0, ends = at_end && p + chunk > length - lanes;
    if (begins || ends) {
      if (begins) std::memset(contiguous, 0, lanes);
      if (ends) std::memset(contiguous + length - lanes + 1, 0, lanes - 1);
      worthwhile = load_bytes(contiguous + p);
    }
    const std::uint64_t picked = nonzero(worthwhile);
    complete = complete && picked == nonzero(slots);
    append_picked(worthwhile, picked, slice + p / lanes, mask, first);
  }
  std::int64_t pairs = 0;
  for (const std::uint8_t* m = before; m < mask; ++m) pairs += mask_tables.count[*m];
  out.pairs += pairs;
  count = static_cast<Index>(mask - before);
  out.first.grow_to(first);
  out.mask.grow_to(mask);
  return complete;
}

// The particles of pairs that no contiguous slot holds.
std::size_t SliceEncoder::collect_loose() {
  const std::size_t length = words_ * lanes;
  const std::uint8_t* const data = bytes_.data() + margin;
  const std::uint8_t* const contiguous = contiguous_.data() + margin;
  reserve(loose_, length + margin);
  reserve(loose_mask_, length + margin);
  const Index* const slice = slice_.data();
  Index* id = loose_.data();
  std::uint8_t* mask = loose_mask_.data();
  for (std::size_t p = 0; p < length; p += chunk) {
    Bytes held = splat_bytes(0);
#pragma GCC unroll 8
    for (int l = 0; l < lanes; ++l) held = held | (load_bytes(contiguous + p - l) & splat_bytes(1 << l));
    const Bytes left = without(load_bytes(data + p), held);
    const std::uint64_t which = nonzero(left);
    append_picked(left, which, slice + p / lanes, mask, id);
  }
  std::memset(mask, 0, lanes + lanes);
  return static_cast<std::size_t>(id - loose_.data());
}

// Slot g of a slice holds the neighbour g of every lane; lanes that have fewer, their own particle. Returns
// the number of slots.
Index SliceEncoder::gather(Index own, std::size_t loose, EncodedSlices& out) {
  const std::size_t stride = loose + 4 * lanes;
  reserve(dealt_, lanes * stride);
  std::size_t count[lanes];
  deal(loose_.data(), loose_mask_.data(), loose, dealt_.data(), stride, count);
  const std::size_t slots = *std::max_element(count, count + lanes);
  std::uint8_t* const masks = out.mask.room(slots);
  const std::size_t least = *std::min_element(count, count + lanes);
  std::memset(masks, 0xff, least);
  for (std::size_t g = least; g < slots; ++g) {
    unsigned m = 0;
    for (int l = 0; l < lanes; ++l) m |= unsigned{g < count[l]} << l;
    masks[g] = static_cast<std::uint8_t>(m);
  }
  for (int l = 0; l < lanes; ++l) {
    out.pairs += static_cast<std::int64_t>(count[l]);
    Index* const rest = dealt_.data() + static_cast<std::size_t>(l) * stride + count[l];
    const auto fill = [&](std::size_t i) { std::fill_n(rest + i, 2 * lanes, own * lanes + l); };
    fill(0);  // nearly always enough, hence no loop that ends unpredictably
    for (std::size_t i = 2 * lanes; count[l] + i < slots; i += 2 * lanes) fill(i);
  }
  out.mask.grow_to(masks + slots);
  Index* const to = out.index.room((slots + lanes) * lanes);
  for (std::size_t g = 0; g < slots; g += lanes) transpose8(dealt_.data() + g, stride, to + g * lanes);
  out.index.grow_to(to + slots * lanes);
  return static_cast<Index>(slots);
}

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
