#pragma once
/// \file
/// The two pair loops of the total Lagrangian forms, eight particles at a time.

#include <taut/core/fields.hpp>
#include <taut/core/operators.hpp>
#include <taut/core/types.hpp>
#include <taut/internal/simd.hpp>
#include <taut/neighbors/pair_list.hpp>

namespace taut {

/// Component pointers of a field, so that inner loops keep them in registers.
template <int N>
struct Columns {
  const double* c[N];
  explicit Columns(const Field& f) {
    for (int i = 0; i < N; ++i) c[i] = f.component(i);
  }
};

/// F of the eight particles of slice s: [sum_b x_ab (x) G_ab] M_a^T.
template <int D, class Real>
TAUT_INLINE void gradient_of_slice(Index s, const PairList& pairs, const Real* vectors, const Columns<D>& x,
                                   const Columns<D * D>& M, Pack (&F)[D * D]) {
  const Index i = s * lanes;
  Pack sum[D * D], xi[D];
  for (int d = 0; d < D; ++d) xi[d] = load(x.c[d] + i);
  for (int c = 0; c < D * D; ++c) sum[c] = pack(0);
  const auto add = [&](std::int64_t k, auto&& neighbour) TAUT_INLINE_LAMBDA {
    const Real* g = vectors + k * D * lanes;
    Pack xab[D];
    for (int d = 0; d < D; ++d) xab[d] = neighbour(x.c[d]) - xi[d];
    for (int e = 0; e < D; ++e) {
      const Pack ge = load(g + e * lanes);
      for (int d = 0; d < D; ++d) sum[d * D + e] += xab[d] * ge;
    }
  };
  const std::int64_t gathered = pairs.gathered(s), end = pairs.begin(s + 1);
  for (std::int64_t k = pairs.begin(s); k < gathered; ++k) {
    const Index first = pairs.first(k);
    add(k, [first](const double* p) TAUT_INLINE_LAMBDA { return load(p + first); });
  }
  for (std::int64_t k = gathered; k < end; ++k) {
    const Index* at = pairs.block(k);
    add(k, [at](const double* p) TAUT_INLINE_LAMBDA { return gather(p, at); });
  }
  for (int d = 0; d < D; ++d)
    for (int e = 0; e < D; ++e) {
      F[d * D + e] = sum[d * D] * load(M.c[e * D] + i);
      for (int j = 1; j < D; ++j) F[d * D + e] += sum[d * D + j] * load(M.c[e * D + j] + i);
    }
}

/// Forces on the eight particles of slice s: Q_a sum_b G_ab - sum_b Q_b G_ba, with the first sum and -G_ba given.
template <int D, class Real>
TAUT_INLINE void force_of_slice(Index s, const PairList& pairs, const Real* adjoint, const Columns<D * D>& Q,
                                const Columns<D>& vector_sum, Pack (&force)[D]) {
  const Index i = s * lanes;
  for (int d = 0; d < D; ++d) {
    force[d] = load(Q.c[d * D] + i) * load(vector_sum.c[0] + i);
    for (int e = 1; e < D; ++e) force[d] += load(Q.c[d * D + e] + i) * load(vector_sum.c[e] + i);
  }
  const auto add = [&](std::int64_t k, auto&& neighbour) TAUT_INLINE_LAMBDA {
    const Real* g = adjoint + k * D * lanes;
    for (int e = 0; e < D; ++e) {
      const Pack ge = load(g + e * lanes);
      for (int d = 0; d < D; ++d) force[d] += neighbour(Q.c[d * D + e]) * ge;
    }
  };
  const std::int64_t gathered = pairs.gathered(s), end = pairs.begin(s + 1);
  for (std::int64_t k = pairs.begin(s); k < gathered; ++k) {
    const Index first = pairs.first(k);
    add(k, [first](const double* p) TAUT_INLINE_LAMBDA { return load(p + first); });
  }
  for (std::int64_t k = gathered; k < end; ++k) {
    const Index* at = pairs.block(k);
    add(k, [at](const double* p) TAUT_INLINE_LAMBDA { return gather(p, at); });
  }
}

}  // namespace taut
