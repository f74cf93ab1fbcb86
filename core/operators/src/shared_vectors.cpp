#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/base/powers.hpp>
#include <taut/operators/block_dictionary.hpp>
#include <taut/operators/pair_payload.hpp>
#include <taut/operators/shared_vectors.hpp>
#include <unordered_map>
#include <unordered_set>

namespace taut {

namespace {

constexpr Index chunk_slices = 512;

// Reference offsets X_a - X_b of the pairs of a slot; zero in lanes without one.
template <int D, class At>
TAUT_INLINE void offsets(const Columns<D>& X, Index s, std::uint8_t mask, const At& at, Pack (&r)[D]) {
  const PackMask pair = lanes_of(mask);
  for (int d = 0; d < D; ++d) r[d] = pair ? load(X.c[d] + s * lanes) - at(X.c[d]) : pack(0);
}

template <int D>
BlockKey key_of(const Pack (&r)[D], std::uint8_t mask, double per_quantum) {
  constexpr std::uint64_t factors[3] = {0x2545f4914f6cdd1d, 0x369dea0f31a53f85, 0x27bb2ee687b0b0fd};
  constexpr double round =
      6755399441055744.0;  // 1.5 * 2^52: what is added to it is rounded to a whole number
  typedef std::uint64_t Words __attribute__((vector_size(sizeof(Pack))));  // products wrap around
  Words word{};
  for (int d = 0; d < D; ++d) {
    const Pack q = r[d] * per_quantum + round;
    Words bits;
    std::memcpy(&bits, &q, sizeof bits);
    word += bits * factors[d];
  }
  BlockKey key;
  key.add(mask);
  for (int l = 0; l < lanes; ++l) key.add(word[l]);
  return key;
}

// f(k, key, r, w): offsets and w_a w_b of each slot. `weights` may be empty where all are alike.
template <int D, class F>
void for_keys(const Particles<D>& p, const PairList& pairs, double support, const Field& weights, Index chunk,
              F&& f) {
  const Columns<D> X(p.X);
  const double* weight = weights.empty() ? nullptr : weights.component(0);
  const double per_quantum = 1 / (alike * int_power(p.dx, 2 * D));
  for (Index s = chunk * chunk_slices; s < std::min((chunk + 1) * chunk_slices, pairs.slices()); ++s)
    for_slots(pairs, s, [&](std::int64_t k, auto&& at) {
      Pack r[D];
      offsets<D>(X, s, pairs.mask(k), at, r);
      BlockKey key = key_of<D>(r, pairs.mask(k), 1 / (alike * support));
      Pack w = pack(1);
      if (weight) {
        w = load(weight + s * lanes) * at(weight);
        for (int l = 0; l < lanes; ++l)
          if (pairs.mask(k) >> l & 1) key.add(static_cast<std::uint64_t>(std::llround(w[l] * per_quantum)));
      }
      f(k, key, r, w);
    });
}

Index chunks_of(const PairList& pairs) { return (pairs.slices() + chunk_slices - 1) / chunk_slices; }

// Turns the numbers of blocks into codes that also tell which components they have.
template <int D>
void mark_components(const PairOperator<D>& op, AlignedArray<Index>& code) {
  constexpr std::size_t block = D * lanes;
  const std::size_t n = op.blocks.size() / block;
  if (n > static_cast<std::size_t>(std::numeric_limits<Index>::max() >> D))
    throw InputError(
        fmt::format("pair_precision \"shared\": {} different blocks of pair vectors are too many to number; "
                    "use \"single\"",
                    n));
  std::vector<Index> codes(n);
  for (std::size_t i = 0; i < n; ++i) {
    Index of_block = static_cast<Index>(i) << D;
    for (int d = 0; d < D; ++d) {
      const double* values = op.blocks.data() + i * block + static_cast<std::size_t>(d * lanes);
      if (std::any_of(values, values + lanes, [](double g) { return g != 0; })) of_block |= 1 << d;
    }
    codes[i] = of_block;
  }
#pragma omp parallel for schedule(static) if (code.size() > 4096)
  for (std::size_t k = 0; k < code.size(); ++k) code[k] = codes[static_cast<std::size_t>(code[k])];
}

// What a slot is like, wherever its slice stands. Index blocks are a slice's own.
SharedSlot shared_slot(const PairList& pairs, const AlignedArray<Index>& code, Index s, std::int64_t k) {
  return {pairs.first(k) - (pairs.is_contiguous(s, k) ? s * lanes : 0), code[static_cast<std::size_t>(k)]};
}

// Keeps the slots of slices that are alike once, those of the first of them: neither they nor their order
// depend on the threads.
template <int D>
void share_slots(const PairList& pairs, const AlignedArray<Index>& code, PairOperator<D>& op) {
  const Index slices = pairs.slices();
  std::vector<BlockKey> keys(static_cast<std::size_t>(slices));
#pragma omp parallel for schedule(static) if (slices > chunk_slices)
  for (Index s = 0; s < slices; ++s) {
    BlockKey& key = keys[static_cast<std::size_t>(s)];
    key.add(static_cast<std::uint64_t>(pairs.gathered(s) - pairs.begin(s)));
    for (std::int64_t k = pairs.begin(s); k < pairs.begin(s + 1); ++k) {
      const SharedSlot slot = shared_slot(pairs, code, s, k);
      key.add(static_cast<std::uint64_t>(static_cast<std::uint32_t>(slot.first)) << 32 |
              static_cast<std::uint32_t>(slot.code));
    }
  }
  std::unordered_map<BlockKey, std::int64_t, BlockKey::Hash> begins;
  std::vector<Index> first_alike;
  std::int64_t slots = 0;
  op.slice_slots = AlignedArray<SharedSlots>(static_cast<std::size_t>(slices));
  for (Index s = 0; s < slices; ++s) {
    const auto [at, fresh] = begins.try_emplace(keys[static_cast<std::size_t>(s)], slots);
    const std::int64_t begin = pairs.begin(s), count = pairs.begin(s + 1) - begin;
    op.slice_slots[static_cast<std::size_t>(s)] = {at->second, static_cast<Index>(pairs.gathered(s) - begin),
                                                   static_cast<Index>(count)};
    if (!fresh) continue;
    first_alike.push_back(s);
    slots += count;
  }
  op.slots = AlignedArray<SharedSlot>(static_cast<std::size_t>(slots));
  std::size_t to = 0;
  for (const Index s : first_alike)
    for (std::int64_t k = pairs.begin(s); k < pairs.begin(s + 1); ++k)
      op.slots[to++] = shared_slot(pairs, code, s, k);
}

}  // namespace

template <int D>
double distinct_fraction(const Particles<D>& p, const PairList& pairs, double support, const Field& weights) {
  constexpr Index samples = 8;
  const Index chunks = chunks_of(pairs), step = std::max(1, chunks / samples);
  std::size_t slots = 0, distinct = 0;
  for (Index c = 0; c < chunks; c += step) {
    std::unordered_set<BlockKey, BlockKey::Hash> keys;
    for_keys<D>(p, pairs, support, weights, c,
                [&](std::int64_t, const BlockKey& key, const Pack(&)[D], Pack) {
                  keys.insert(key);
                  ++slots;
                });
    distinct += keys.size();
  }
  return slots ? static_cast<double>(distinct) / static_cast<double>(slots) : 1;
}

template <int D>
void share_vectors(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h,
                   PairOperator<D>& op) {
  const Index chunks = chunks_of(pairs);
  BlockDictionary dictionary(static_cast<std::size_t>(pairs.slots()), static_cast<std::size_t>(chunks),
                             D * lanes);
  const double support = kernel.radius_factor() * h;
  parallel_for_dynamic(chunks, 1, chunks > 1, [&](Index c) {
    for_keys<D>(
        p, pairs, support, op.weight, c, [&](std::int64_t k, const BlockKey& key, const Pack(&r)[D], Pack w) {
          dictionary.put(static_cast<std::size_t>(c), static_cast<std::size_t>(k), key, [&](double* block) {
            for (int l = 0; l < lanes; ++l) {
              if (!(pairs.mask(k) >> l & 1)) continue;
              double r2 = 0;
              for (int d = 0; d < D; ++d) r2 += r[d][l] * r[d][l];
              const double distance = std::sqrt(r2);
              const double slope = op.weight_product * w[l] * kernel.derivative(distance, h) / distance;
              for (int d = 0; d < D; ++d) block[d * lanes + l] = slope * r[d][l];
            }
          });
        });
  });
  AlignedArray<Index> code;  // of each slot of the list
  dictionary.finish(code, op.blocks);
  mark_components<D>(op, code);
  share_slots<D>(pairs, code, op);
}

#define TAUT_INSTANTIATE(D)                                                                         \
  template double distinct_fraction<D>(const Particles<D>&, const PairList&, double, const Field&); \
  template void share_vectors<D>(const Particles<D>&, const PairList&, const Kernel&, double,       \
                                 PairOperator<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
