#pragma once
/// \file
/// Where pair loops take their neighbours, pair vectors and particle matrices from.

#include <taut/base/fields.hpp>
#include <taut/base/simd.hpp>
#include <taut/base/types.hpp>
#include <taut/kernels/kernel_table.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/operators.hpp>
#include <utility>

namespace taut {

/// Component pointers of a field, so that inner loops keep them in registers.
template <int N>
struct Columns {
  const double* c[N];
  explicit Columns(const Field& f) {
    for (int i = 0; i < N; ++i) c[i] = f.component(i);
  }
};

/// Calls f(k, at) for each slot k of slice s; at(p) are the values of a component p at the slot's neighbours.
template <class F>
TAUT_INLINE void for_slots(const PairList& pairs, Index s, F&& f) {
  const std::int64_t gathered = pairs.gathered(s), end = pairs.begin(s + 1);
  for (std::int64_t k = pairs.begin(s); k < gathered; ++k)
    f(k, [first = pairs.first(k)](const double* p) TAUT_INLINE_LAMBDA { return load(p + first); });
  for (std::int64_t k = gathered; k < end; ++k)
    f(k, [at = pairs.block(k)](const double* p) TAUT_INLINE_LAMBDA { return gather(p, at); });
}

// A payload gives, for one slice, the eight pair vectors G_ab of a slot, component by component:
// `slice(s).components(k, at, f)` calls f(d, G_d), where G_d is zero in lanes without a pair. It may leave
// out components that are zero in all lanes. It counts slots as the pair list does, or has its own way to go
// over them: then `for_slots` and `furthest` have overloads for it.

template <int D, class Real>
struct StoredVectors {
  const Real *vectors, *adjoints;

  StoredVectors adjoint() const { return {adjoints, vectors}; }
  TAUT_INLINE const StoredVectors& slice(Index) const { return *this; }
  template <class At, class F>
  TAUT_INLINE void components(std::int64_t k, const At&, F&& f) const {
    for (int d = 0; d < D; ++d) f(d, load(vectors + (k * D + d) * lanes));
  }
};

template <int D>
struct SharedVectors {
  const SharedSlots* slots_of;
  const SharedSlot* slots;
  const double* blocks;

  const SharedVectors& adjoint() const { return *this; }
  TAUT_INLINE const SharedVectors& slice(Index) const { return *this; }
  template <class At, class F>
  TAUT_INLINE void components(std::int64_t k, const At&, F&& f) const {
    // On a lattice most vectors lie along an axis or in a plane of two: what they leave out need not be
    // loaded.
    const Index c = slots[k].code;
    const double* block = blocks + static_cast<std::int64_t>(c >> D) * (D * lanes);
    for (int d = 0; d < D; ++d)
      if (c >> d & 1) f(d, load(block + d * lanes));
  }
};

template <int D>
struct RecomputedVectors {
  const KernelTable& table;
  const PairList& pairs;
  Columns<D> X;
  double factor;         // w_a w_b where all weigh alike
  const double* weight;  // else their weights

  const RecomputedVectors& adjoint() const { return *this; }
  struct Slice {
    const RecomputedVectors& of;
    Pack Xi[D], factor;
    template <class At, class F>
    TAUT_INLINE void components(std::int64_t k, const At& at, F&& f) const {
      Pack g[D], r2 = pack(0);
      for (int d = 0; d < D; ++d) {
        g[d] = Xi[d] - at(of.X.c[d]);
        r2 += g[d] * g[d];
      }
      // What is nearer than the support is the list's to say: the table rounds in another order.
      const Pack slope = of.table.slope_over_r(r2);
      const Pack weights = of.weight ? factor * at(of.weight) : factor;
      const Pack w = lanes_of(of.pairs.mask(k)) ? slope * weights : pack(0);
      for (int d = 0; d < D; ++d) f(d, g[d] * w);
    }
  };
  TAUT_INLINE Slice slice(Index s) const {
    Slice slice{*this, {}, weight ? load(weight + s * lanes) : pack(factor)};
    for (int d = 0; d < D; ++d) slice.Xi[d] = load(X.c[d] + s * lanes);
    return slice;
  }
};

/// The same, with k as the payload counts slots.
template <class Payload, class F>
TAUT_INLINE void for_slots(const PairList& pairs, const Payload&, Index s, F&& f) {
  for_slots(pairs, s, f);
}
template <int D, class F>
TAUT_INLINE void for_slots(const PairList& pairs, const SharedVectors<D>& shared, Index s, F&& f) {
  const SharedSlots of = shared.slots_of[s];
  const std::int64_t gathered = of.begin + of.contiguous, end = of.begin + of.count;
  const Index own = s * lanes;
  for (std::int64_t k = of.begin; k < gathered; ++k)
    f(k,
      [first = own + shared.slots[k].first](const double* p) TAUT_INLINE_LAMBDA { return load(p + first); });
  for (std::int64_t k = gathered; k < end; ++k)
    f(k, [at = pairs.indices(shared.slots[k].first)](const double* p)
             TAUT_INLINE_LAMBDA { return gather(p, at); });
}

/// The last neighbour of a slice's last contiguous slot, or -1 where all are gathered.
TAUT_INLINE Index furthest(const PairList& pairs, Index s) {
  const std::int64_t k = pairs.gathered(s);
  return k == pairs.begin(s) ? -1 : pairs.first(k - 1) + lanes - 1;
}
/// The same, with the slots as the payload keeps them.
template <class Payload>
TAUT_INLINE Index furthest(const PairList& pairs, const Payload&, Index s) {
  return furthest(pairs, s);
}
template <int D>
TAUT_INLINE Index furthest(const PairList&, const SharedVectors<D>& shared, Index s) {
  const SharedSlots of = shared.slots_of[s];
  if (of.contiguous == 0) return -1;
  return (s + 1) * lanes - 1 + shared.slots[of.begin + of.contiguous - 1].first;
}

/// Asks for what slice s will be the first to touch, a few slices before its turn: the neighbours furthest
/// on. A component of every row of neighbours is a stream of its own, more than hardware prefetchers follow.
/// `payload` is that of the loop over the slots, if it has one.
template <int N, class... Payload>
TAUT_INLINE void prefetch_neighbours(const PairList& pairs, Index s, const Columns<N>& columns,
                                     const Payload&... payload) {
  constexpr Index ahead = 4;
  if (s + ahead >= pairs.slices()) return;
  const Index last = furthest(pairs, payload..., s + ahead);
  if (last < 0) return;
  for (int c = 0; c < N; ++c) __builtin_prefetch(columns.c[c] + last);
}

/// M_a and sum_b G_ab of the eight particles of a slice.
template <int D>
struct SliceCoefficients {
  const double *M, *s;
  std::size_t stride_M, stride_s;

  SliceCoefficients(const PairOperator<D>& op, Index slice) {
    if (op.slice_code.empty()) {
      M = op.M.component(0) + slice * lanes;
      s = op.sum.component(0) + slice * lanes;
      stride_M = op.M.stride();
      stride_s = op.sum.stride();
    } else {
      M = op.slice_blocks.data() +
          static_cast<std::int64_t>(op.slice_code[static_cast<std::size_t>(slice)]) * ((D * D + D) * lanes);
      s = M + D * D * lanes;
      stride_M = stride_s = lanes;
    }
  }
  TAUT_INLINE Pack matrix(int c) const { return load(M + static_cast<std::size_t>(c) * stride_M); }
  /// Component e of row · M.
  TAUT_INLINE Pack times_matrix(const Pack* row, int e) const {
    Pack product = row[0] * matrix(e);
    for (int j = 1; j < D; ++j) product += row[j] * matrix(j * D + e);
    return product;
  }
  TAUT_INLINE Pack sum(int d) const { return load(s + static_cast<std::size_t>(d) * stride_s); }
};

/// Calls f(payload) with the payload of an operator.
template <int D, class F>
auto with_payload(const PairOperator<D>& op, const PairList& pairs, const Field& X, F&& f) {
  switch (op.precision) {
    case PairPrecision::double_precision:
      return f(StoredVectors<D, double>{op.vectors_d.data(), op.adjoint(op.vectors_d.data())});
    case PairPrecision::shared:
      return f(SharedVectors<D>{op.slice_slots.data(), op.slots.data(), op.blocks.data()});
    case PairPrecision::recomputed:
      return f(RecomputedVectors<D>{*op.table, pairs, Columns<D>(X), op.weight_product,
                                    op.weight.empty() ? nullptr : op.weight.component(0)});
    case PairPrecision::single_precision:
    case PairPrecision::automatic:
      break;
  }
  return f(StoredVectors<D, float>{op.vectors_f.data(), op.adjoint(op.vectors_f.data())});
}

}  // namespace taut
