#pragma once
/// \file
/// Storing pair vectors that are not antisymmetric.

#include <taut/base/parallel.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/operators.hpp>
#include <taut/particles/particles.hpp>
#include <utility>

namespace taut {

/// What `store_pair_vectors` does in one precision.
template <int D, class Real, class F>
void replace_pair_vectors(const Particles<D>& p, const PairList& pairs, const F& vectors,
                          AlignedArray<Real>& own_of_op, AlignedArray<Real>& adjoint_of_op) {
  const auto size = static_cast<std::size_t>(pairs.slots()) * D * lanes;
  AlignedArray<Real> own(size), adjoint(size);
  parallel_for_dynamic(p.total, 512, true, [&](Index a) {
    const Vec<D> Xa = p.X.template vec<D>(a);
    pairs.for_each(a, [&](Index b, std::int64_t k, int lane) {
      const std::pair<Vec<D>, Vec<D>> both = vectors(a, b, k, lane, Vec<D>(p.X.template vec<D>(b) - Xa));
      for (int d = 0; d < D; ++d) {
        const auto at = static_cast<std::size_t>((k * D + d) * lanes + lane);
        own[at] = static_cast<Real>(both.first[d]);
        adjoint[at] = static_cast<Real>(both.second[d]);
      }
    });
  });
  own_of_op = std::move(own);
  adjoint_of_op = std::move(adjoint);
}

/// Stores G_ab and, beside it, -G_ba for each directed pair, in the precision of `op`, in place of what `op`
/// had. `vectors(a, b, k, lane, X_b - X_a)` gives the two; it may read the old ones. So that momentum is kept
/// to round-off it must return the same bits for -G_ba, seen from a, as for minus G_ba, seen from b.
template <int D, class F>
void store_pair_vectors(const Particles<D>& p, const PairList& pairs, const F& vectors, PairOperator<D>& op) {
  if (op.precision == PairPrecision::single_precision)
    replace_pair_vectors(p, pairs, vectors, op.vectors_f, op.adjoint_f);
  else
    replace_pair_vectors(p, pairs, vectors, op.vectors_d, op.adjoint_d);
}

}  // namespace taut
