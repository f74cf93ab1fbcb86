#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/base/powers.hpp>
#include <taut/operators/antisymmetric_operator.hpp>
#include <taut/operators/block_dictionary.hpp>
#include <taut/operators/compatible_operator.hpp>
#include <taut/operators/operators.hpp>
#include <taut/operators/pair_passes.hpp>
#include <taut/operators/quadratic_operator.hpp>
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

// The vectors along the kernel's gradient in the precision of `op`, or what they are shared or recomputed
// from.
template <int D>
void fill_radial_vectors(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h,
                         PairOperator<D>& op) {
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
PairPrecision resolve(const Method& method, const Particles<D>& p, const PairList& pairs, double support,
                      const Field& weights) {
  if (method.pair_precision != PairPrecision::automatic) return method.pair_precision;
  if (!p.spacing.empty()) return PairPrecision::single_precision;
  // A slot that nothing is shared with costs twice the bytes of one in single precision.
  constexpr double worthwhile = 0.4;
  return method.operators != "quadratic" && distinct_fraction<D>(p, pairs, support, weights) < worthwhile
             ? PairPrecision::shared
             : PairPrecision::single_precision;
}

bool is_stored(PairPrecision precision) {
  return precision == PairPrecision::single_precision || precision == PairPrecision::double_precision;
}

void require_stored(const Method& method, PairPrecision precision) {
  if (!is_stored(precision))
    throw InputError(fmt::format("the pair vectors of {} operators cannot be {}: choose single or double",
                                 method.operators, to_string(precision)));
}

}  // namespace

bool needs_areas(std::string_view operators) {
  return operators == "compatible" || operators == "antisymmetric";
}
double rough_limit(std::string_view operators) {
  // From bench/HEALTH.md. What does not quite close is softer: it makes up for part of what bending lacks.
  return operators == "antisymmetric" ? 0.5 : 0.2;
}
std::vector<std::string> operator_names() {
  return {"standard", "corrected", "compatible", "antisymmetric", "quadratic"};
}

template <int D>
PairOperator<D> make_operator(const Method& method, const Particles<D>& p, const PairList& pairs,
                              const Kernel& kernel, double h) {
  const std::string& name = method.operators;
  const auto names = operator_names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw InputError(fmt::format("unknown operators \"{}\"; valid: {}", name, join_names(names)));
  const double support = kernel.radius_factor() * h;

  PairOperator<D> op;
  if (name == "standard")
    op.weight = p.V;
  else
    op.weight_product = int_power(p.dx, 2 * D);
  op.precision = resolve<D>(method, p, pairs, support, op.weight);
  if (!p.spacing.empty() && !is_stored(op.precision))
    throw InputError(fmt::format("the pair vectors of graded clouds cannot be {}: choose single or double",
                                 to_string(op.precision)));
  const auto make_matrices = [&] {
    with_payload<D>(op, pairs, p.X, [&](const auto& payload) {
      fill_matrices<D>(name != "standard", p, pairs, payload, op);
    });
  };
  if (name == "quadratic") {
    require_stored(method, op.precision);
    if (!p.spacing.empty())
      throw InputError(
          "quadratic operators have one support for all particles, which this cloud is too graded for: use "
          "compatible operators");
    make_quadratic(p, pairs, kernel, h, op);
  } else {
    fill_radial_vectors(p, pairs, kernel, h, op);
  }
  make_matrices();
  const bool automatic = method.pair_precision == PairPrecision::automatic;
  const bool antisymmetric = name == "antisymmetric";
  if (needs_areas(name) && !(automatic && is_closed(p, pairs, op))) {
    if (automatic && !is_stored(op.precision)) {
      op = {};
      op.weight_product = int_power(p.dx, 2 * D);
      fill_radial_vectors(p, pairs, kernel, h, op);
      make_matrices();
    }
    require_stored(method, op.precision);
    if (antisymmetric) {
      make_antisymmetric<D>(p, pairs, method.compatible_iterations, op, make_matrices);
    } else {
      make_compatible(p, pairs, method.compatible_iterations, op);
      make_matrices();  // linear exactness of the vectors as stored
    }
  }
  if (op.precision != PairPrecision::recomputed) op.weight = {};  // they are in the vectors
  return op;
}

#define TAUT_INSTANTIATE(D)                                                                      \
  template PairOperator<D> make_operator<D>(const Method&, const Particles<D>&, const PairList&, \
                                            const Kernel&, double);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
