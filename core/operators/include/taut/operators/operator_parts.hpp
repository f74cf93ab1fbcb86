#pragma once
/// \file
/// What operators are put together from.

#include <taut/base/parallel.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/registry.hpp>
#include <taut/particles/particles.hpp>
#include <utility>

namespace taut {

/// An operator without vectors, in the precision that the method asks for. Particles weigh alike, or as
/// `weight` says (one value each). Vectors that are not those of the kernel's gradient, whose payload is not
/// `shareable`, must be stored. \throws InputError where the method wants them otherwise, and for graded
/// clouds unless they are stored.
template <int D>
PairOperator<D> start_operator(const OperatorSetup<D>& setup, bool shareable = true, Field weight = {});

/// Fills in the vectors w_a w_b grad W_ab, or what they are shared or recomputed from.
template <int D>
void fill_radial_vectors(const OperatorSetup<D>& setup, PairOperator<D>& op);

/// Makes M and the sums of the vectors as they are kept: M_a = [sum_b G_ab (x) X_ab]^-1 where `corrected`, so
/// that linear fields are exact, else I / V_a. \throws InputError for a particle whose matrix is singular.
template <int D>
void make_matrices(const OperatorSetup<D>& setup, bool corrected, PairOperator<D>& op);

/// The start of most operators: radial vectors and the matrices that correct them.
template <int D>
PairOperator<D> make_corrected(const OperatorSetup<D>& setup);

/// \throws InputError where vectors are to be shared or recomputed.
void require_stored(const Method& method, PairPrecision precision);
bool is_stored(PairPrecision precision);

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
