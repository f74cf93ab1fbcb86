#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/base/powers.hpp>
#include <taut/operators/block_dictionary.hpp>
#include <taut/operators/operator_parts.hpp>
#include <taut/operators/pair_passes.hpp>
#include <taut/operators/shared_vectors.hpp>

namespace taut {

namespace {

constexpr Index chunk_slices = 512;

// G_ab = w_a w_b grad W_ab for all slots; antisymmetric to the last bit, because every factor is.
template <int D, class Real>
void fill_vectors(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h,
                  const PairOperator<D>& op, AlignedArray<Real>& out) {
  out = AlignedArray<Real>(static_cast<std::size_t>(pairs.slots()) * D * lanes);
  const double* w = op.weight.empty() ? nullptr : op.weight.component(0);
  parallel_for(pairs.slices(), true, [&](Index s) {
    for (Index a = s * lanes; a < std::min<Index>((s + 1) * lanes, pairs.particles()); ++a)
      pairs.for_each(a, [&](Index b, std::int64_t k, int lane) {
        const Vec<D> rab = p.X.template vec<D>(a) - p.X.template vec<D>(b);
        const double r = rab.norm();
        const double scale = p.support_scale(a, b);
        const double weight = w ? w[a] * w[b] : op.weight_product * (scale == 1 ? 1 : std::pow(scale, 2 * D));
        const double slope = weight * kernel.derivative(r, h * scale) / r;
        for (int d = 0; d < D; ++d)
          out[static_cast<std::size_t>((k * D + d) * lanes + lane)] = static_cast<Real>(slope * rab[d]);
      });
  });
}

// The sums that a slice's matrices are made of.
template <int D>
struct Moments {
  Pack outer[D * D];  // sum_b X_ab (x) G_ab
  Pack sum[D];        // sum_b G_ab
  Pack scale;         // sum_b |X_ab| |G_ab|
};

template <int D, class Payload>
void moments_of_slice(Index s, const PairList& pairs, const Payload& payload, const Columns<D>& X,
                      Moments<D>& m) {
  Pack Xi[D];
  for (int d = 0; d < D; ++d) Xi[d] = load(X.c[d] + s * lanes);
  for (auto& c : m.outer) c = pack(0);
  for (auto& c : m.sum) c = pack(0);
  m.scale = pack(0);
  const auto vectors = payload.slice(s);
  for_slots(pairs, payload, s, [&](std::int64_t k, auto&& at) {
    Pack Xab[D], gg = pack(0), XX = pack(0);
    for (int d = 0; d < D; ++d) {
      Xab[d] = at(X.c[d]) - Xi[d];
      XX += Xab[d] * Xab[d];
    }
    vectors.components(k, at, [&](int e, Pack g) {
      gg += g * g;
      for (int d = 0; d < D; ++d) m.outer[d * D + e] += Xab[d] * g;
      m.sum[e] += g;
    });
    for (int l = 0; l < lanes; ++l) m.scale[l] += std::sqrt(gg[l] * XX[l]);
  });
}

template <int D>
[[noreturn]] void throw_singular(const Particles<D>& p, const PairList& pairs, Index a) {
  Index neighbours = 0;
  pairs.for_each(a, [&](Index, std::int64_t, int) { ++neighbours; });
  throw InputError(
      fmt::format("corrected operator: the correction matrix of particle {} at {} is singular: its {} "
                  "neighbour(s) do not span {} "
                  "dimension(s). Enlarge support_dx, refine dx, or thicken the body there",
                  p.id[a], describe<D>(p.reference_position(a)), neighbours, D));
}

// Matrices of one slice as the loops want them: M, then the sums.
template <int D>
using Coefficients = Pack[D * D + D];

// False where the matrix of the particle in lane l is singular.
template <int D>
bool invert_moment(const Moments<D>& m, int l, Coefficients<D>& out) {
  Mat<D> moment;  // sum_b G_ab (x) X_ab
  for (int c = 0; c < D * D; ++c) moment(c % D, c / D) = m.outer[c][l];
  // Relative to the size it would have with neighbours all around: 1e-7 of it is rank deficiency in single
  // precision.
  if (!(std::abs(moment.determinant()) > 1e-7 * int_power(m.scale[l] / D, D))) return false;
  const Mat<D> inverse = moment.inverse();
  for (int c = 0; c < D * D; ++c) out[c][l] = inverse(c / D, c % D);
  return true;
}

template <int D>
BlockKey key_of(const Coefficients<D>& c, double dx) {
  const auto quantised = [](double v) { return static_cast<std::uint64_t>(std::llround(v / alike)); };
  const double matrix_unit = int_power(dx, D), sum_unit = int_power(dx, 1 - D);
  BlockKey key;
  for (int l = 0; l < lanes; ++l) {
    for (int k = 0; k < D * D; ++k) key.add(quantised(c[k][l] * matrix_unit));
    for (int k = D * D; k < D * D + D; ++k) key.add(quantised(c[k][l] * sum_unit));
  }
  return key;
}

// M and the sums of all slices, in fields or, where vectors are shared, in a dictionary.
template <int D, class Payload>
void fill_matrices(bool corrected, const Particles<D>& p, const PairList& pairs, const Payload& payload,
                   PairOperator<D>& op) {
  const auto total = static_cast<std::size_t>(p.total);
  const Index slices = static_cast<Index>(padded(static_cast<std::size_t>(p.n)) / lanes);
  const Index chunks = (slices + chunk_slices - 1) / chunk_slices;
  const bool shared = op.precision == PairPrecision::shared;
  BlockDictionary dictionary(shared ? static_cast<std::size_t>(slices) : 0, static_cast<std::size_t>(chunks),
                             (D * D + D) * lanes);
  if (!shared) {
    op.M = Field(total, D * D);
    op.sum = Field(total, D);
  }
  const Columns<D> X(p.X);
  const double* V = p.V.component(0);
  std::atomic<Index> singular{p.n};
  parallel_for(chunks, chunks > 1, [&](Index chunk) {
    for (Index s = chunk * chunk_slices; s < std::min((chunk + 1) * chunk_slices, slices); ++s) {
      Moments<D> m;
      moments_of_slice<D>(s, pairs, payload, X, m);
      Coefficients<D> c{};
      for (int l = 0; l < std::min<Index>(lanes, p.n - s * lanes); ++l) {
        const Index a = s * lanes + l;
        for (int d = 0; d < D; ++d) c[D * D + d][l] = m.sum[d][l];
        if (!corrected) {
          for (int d = 0; d < D; ++d) c[d * (D + 1)][l] = 1 / V[a];
        } else if (!invert_moment<D>(m, l, c)) {
          Index seen = singular.load();
          while (a < seen && !singular.compare_exchange_weak(seen, a)) {
          }
        }
      }
      if (shared) {
        dictionary.put(static_cast<std::size_t>(chunk), static_cast<std::size_t>(s), key_of<D>(c, p.dx),
                       [&](double* block) {
                         for (int k = 0; k < D * D + D; ++k) store(block + k * lanes, c[k]);
                       });
      } else {
        for (int k = 0; k < D * D; ++k) store(op.M.component(k) + s * lanes, c[k]);
        for (int d = 0; d < D; ++d) store(op.sum.component(d) + s * lanes, c[D * D + d]);
      }
    }
  });
  if (singular.load() < p.n) throw_singular(p, pairs, singular.load());
  if (shared) dictionary.finish(op.slice_code, op.slice_blocks);
}

// What `automatic` means for these particles.
template <int D>
PairPrecision resolve(const OperatorSetup<D>& setup, bool shareable, const Field& weights) {
  if (setup.method.pair_precision != PairPrecision::automatic) return setup.method.pair_precision;
  if (!shareable || !setup.particles.spacing.empty()) return PairPrecision::single_precision;
  // A slot that nothing is shared with costs twice the bytes of one in single precision.
  constexpr double worthwhile = 0.4;
  return distinct_fraction<D>(setup.particles, setup.pairs, setup.support(), weights) < worthwhile
             ? PairPrecision::shared
             : PairPrecision::single_precision;
}

}  // namespace

bool is_stored(PairPrecision precision) {
  return precision == PairPrecision::single_precision || precision == PairPrecision::double_precision;
}

void require_stored(const Method& method, PairPrecision precision) {
  if (!is_stored(precision))
    throw InputError(fmt::format("the pair vectors of {} operators cannot be {}: choose single or double",
                                 method.operators, to_string(precision)));
}

template <int D>
PairOperator<D> start_operator(const OperatorSetup<D>& setup, bool shareable, Field weight) {
  PairOperator<D> op;
  if (weight.empty())
    op.weight_product = int_power(setup.particles.dx, 2 * D);
  else
    op.weight = std::move(weight);
  op.precision = resolve<D>(setup, shareable, op.weight);
  if (!setup.particles.spacing.empty() && !is_stored(op.precision))
    throw InputError(fmt::format("the pair vectors of graded clouds cannot be {}: choose single or double",
                                 to_string(op.precision)));
  if (!shareable) require_stored(setup.method, op.precision);
  return op;
}

template <int D>
void fill_radial_vectors(const OperatorSetup<D>& setup, PairOperator<D>& op) {
  const auto& [method, p, pairs, kernel, h] = setup;
  switch (op.precision) {
    case PairPrecision::double_precision:
      fill_vectors(p, pairs, kernel, h, op, op.vectors_d);
      break;
    case PairPrecision::shared:
      share_vectors<D>(p, pairs, kernel, h, op);
      break;
    case PairPrecision::recomputed:
      op.table = std::make_shared<const KernelTable>(kernel, h);
      break;
    default:
      fill_vectors(p, pairs, kernel, h, op, op.vectors_f);
  }
}

template <int D>
void make_matrices(const OperatorSetup<D>& setup, bool corrected, PairOperator<D>& op) {
  with_payload<D>(op, setup.pairs, setup.particles.X, [&](const auto& payload) {
    fill_matrices<D>(corrected, setup.particles, setup.pairs, payload, op);
  });
}

template <int D>
PairOperator<D> make_operator(const Method& method, const Particles<D>& p, const PairList& pairs,
                              const Kernel& kernel, double h) {
  const OperatorEntry& entry = operator_registry().find(method.operators);
  PairOperator<D> op = maker_of<D>(entry, "operators")(OperatorSetup<D>{method, p, pairs, kernel, h});
  if (op.precision != PairPrecision::recomputed) op.weight = {};  // they are in the vectors
  return op;
}

#define TAUT_INSTANTIATE(D)                                                                      \
  template PairOperator<D> start_operator<D>(const OperatorSetup<D>&, bool, Field);              \
  template void fill_radial_vectors<D>(const OperatorSetup<D>&, PairOperator<D>&);               \
  template void make_matrices<D>(const OperatorSetup<D>&, bool, PairOperator<D>&);               \
  template PairOperator<D> make_operator<D>(const Method&, const Particles<D>&, const PairList&, \
                                            const Kernel&, double);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
