#pragma once
/// \file
/// The two pair loops of the total Lagrangian forms, eight particles at a time.

#include <taut/base/fields.hpp>
#include <taut/base/simd.hpp>
#include <taut/base/types.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/pair_payload.hpp>

namespace taut {

/// sum_b u_ab (x) G_ab of the eight particles of slice s (row-major).
template <int D, class Payload>
TAUT_INLINE void outer_sum_of_slice(Index s, const PairList& pairs, const Payload& payload,
                                    const Columns<D>& u, Pack (&sum)[D * D]) {
  Pack ui[D];
  for (int d = 0; d < D; ++d) ui[d] = load(u.c[d] + s * lanes);
  for (int c = 0; c < D * D; ++c) sum[c] = pack(0);
  const auto vectors = payload.slice(s);
  for_slots(pairs, payload, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
    Pack uab[D];
    for (int d = 0; d < D; ++d) uab[d] = at(u.c[d]) - ui[d];
    vectors.components(k, at, [&](int e, Pack g) TAUT_INLINE_LAMBDA {
      for (int d = 0; d < D; ++d) sum[d * D + e] += uab[d] * g;
    });
  });
}

/// H = grad u of the eight particles of slice s: [sum_b u_ab (x) G_ab] M_a^T.
template <int D, class Payload>
TAUT_INLINE void gradient_of_slice(Index s, const PairList& pairs, const Payload& payload,
                                   const Columns<D>& u, const SliceCoefficients<D>& of, Pack (&H)[D * D]) {
  Pack sum[D * D];
  outer_sum_of_slice<D>(s, pairs, payload, u, sum);
  for (int d = 0; d < D; ++d)
    for (int e = 0; e < D; ++e) {
      H[d * D + e] = sum[d * D] * of.matrix(e * D);
      for (int j = 1; j < D; ++j) H[d * D + e] += sum[d * D + j] * of.matrix(e * D + j);
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
