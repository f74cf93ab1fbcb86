#pragma once
/// \file
/// The two pair loops of the total Lagrangian forms, eight particles at a time.

#include <taut/core/fields.hpp>
#include <taut/core/types.hpp>
#include <taut/internal/pair_payload.hpp>
#include <taut/internal/simd.hpp>
#include <taut/neighbors/pair_list.hpp>

namespace taut {

/// sum_b x_ab (x) G_ab of the eight particles of slice s (row-major).
template <int D, class Payload>
TAUT_INLINE void outer_sum_of_slice(Index s, const PairList& pairs, const Payload& payload,
                                    const Columns<D>& x, Pack (&sum)[D * D]) {
  Pack xi[D];
  for (int d = 0; d < D; ++d) xi[d] = load(x.c[d] + s * lanes);
  for (int c = 0; c < D * D; ++c) sum[c] = pack(0);
  const auto vectors = payload.slice(s);
  for_slots(pairs, payload, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
    Pack xab[D];
    for (int d = 0; d < D; ++d) xab[d] = at(x.c[d]) - xi[d];
    vectors.components(k, at, [&](int e, Pack g) TAUT_INLINE_LAMBDA {
      for (int d = 0; d < D; ++d) sum[d * D + e] += xab[d] * g;
    });
  });
}

/// F (without F0) of the eight particles of slice s: [sum_b x_ab (x) G_ab] M_a^T.
template <int D, class Payload>
TAUT_INLINE void gradient_of_slice(Index s, const PairList& pairs, const Payload& payload,
                                   const Columns<D>& x, const SliceCoefficients<D>& of, Pack (&F)[D * D]) {
  Pack sum[D * D];
  outer_sum_of_slice<D>(s, pairs, payload, x, sum);
  for (int d = 0; d < D; ++d)
    for (int e = 0; e < D; ++e) {
      F[d * D + e] = sum[d * D] * of.matrix(e * D);
      for (int j = 1; j < D; ++j) F[d * D + e] += sum[d * D + j] * of.matrix(e * D + j);
    }
}

/// Forces on the eight particles of slice s: Q_a sum_b G_ab - sum_b Q_b G_ba, with the first sum given.
template <int D, class Payload>
TAUT_INLINE void force_of_slice(Index s, const PairList& pairs, const Payload& payload,
                                const Columns<D * D>& Q, const SliceCoefficients<D>& of, Pack (&force)[D]) {
  const Index i = s * lanes;
  for (int d = 0; d < D; ++d) {
    force[d] = load(Q.c[d * D] + i) * of.sum(0);
    for (int e = 1; e < D; ++e) force[d] += load(Q.c[d * D + e] + i) * of.sum(e);
  }
  const auto vectors = payload.adjoint().slice(s);
  for_slots(pairs, payload, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
    vectors.components(k, at, [&](int e, Pack g) TAUT_INLINE_LAMBDA {
      for (int d = 0; d < D; ++d) force[d] += at(Q.c[d * D + e]) * g;
    });
  });
}

}  // namespace taut
