#include <cmath>
#include <taut/base/powers.hpp>
#include <taut/operators/closure_system.hpp>
#include <taut/operators/compatible_operator.hpp>
#include <taut/operators/operator_entries.hpp>
#include <taut/operators/operator_parts.hpp>
#include <taut/operators/pair_passes.hpp>

namespace taut {

template <int D>
bool is_closed(const Particles<D>& p, const PairList& pairs, const PairOperator<D>& op) {
  check_areas(p);
  // The forces of a unit stress, which the areas take up.
  Field stress(static_cast<std::size_t>(p.total), D * D);
  const Index slices = (p.n + lanes - 1) / lanes;
#pragma omp parallel for schedule(static)
  for (Index s = 0; s < slices; ++s) {
    const SliceCoefficients<D> of(op, s);
    const Pack V = load(p.V.component(0) + s * lanes);
    for (int c = 0; c < D * D; ++c) store(stress.component(c) + s * lanes, V * of.matrix(c));
  }
  p.mirror.tensors(stress);
  const double negligible = 1e-4 * int_power(p.dx, D - 1);
  bool closed = true;
  with_payload<D>(op, pairs, p.X, [&](const auto& payload) {
    const Columns<D * D> Q(stress);
    for (Index s = 0; closed && s < slices; ++s) {
      Pack force[D];
      force_of_slice<D>(s, pairs, payload, Q, {op, s}, force);
      for (Index a = s * lanes; a < std::min<Index>((s + 1) * lanes, p.n); ++a)
        for (int d = 0; d < D; ++d)
          closed =
              closed && std::abs(force[d][a - s * lanes] + p.B[static_cast<std::size_t>(a)][d]) < negligible;
    }
  });
  return closed;
}

namespace {

// V M g_ab + mu X_ab + lambda_a - lambda_b, with V, M and mu of a for G_ab, of b for -G_ba: one function for
// both, not inlined, so that they are the same numbers bit for bit.
template <int D>
[[gnu::noinline]] Vec<D> changed(double V, const Mat<D>& M, const Vec<D>& g, const Mat<D>& mu,
                                 const Vec<D>& X, const Vec<D>& difference) {
  return V * (M * g) + (mu * X + difference);
}

}  // namespace

template <int D>
double make_compatible(const Particles<D>& p, const PairList& pairs, int iterations, PairOperator<D>& op) {
  check_areas(p);
  p.mirror.tensors(op.M);
  ClosureSystem<D> system(p, pairs, op);
  const auto [lambda, residual] = system.solve(iterations);

  store_pair_vectors(
      p, pairs,
      [&, &lambda = lambda](Index a, Index b, std::int64_t k, int lane, const Vec<D>& X) {
        const Vec<D> difference = lambda.template vec<D>(a) - lambda.template vec<D>(b);
        const Vec<D> g = op.vector(k, lane);
        return std::pair<Vec<D>, Vec<D>>(
            changed<D>(p.V.component(0)[a], op.M.template mat<D>(a), g, system.mu(a), X, difference),
            changed<D>(p.V.component(0)[b], op.M.template mat<D>(b), g, system.mu(b), X, difference));
      },
      op);
  return residual;
}

template <int D>
bool start_closure(const OperatorSetup<D>& setup, PairOperator<D>& op) {
  const bool automatic = setup.method.pair_precision == PairPrecision::automatic;
  op = make_corrected(setup);
  if (automatic && is_closed(setup.particles, setup.pairs, op)) return false;
  if (automatic && !is_stored(op.precision)) {
    Method stored = setup.method;
    stored.pair_precision = PairPrecision::single_precision;
    op = make_corrected<D>({stored, setup.particles, setup.pairs, setup.kernel, setup.smoothing_length});
  }
  require_stored(setup.method, op.precision);
  return true;
}

namespace {

template <int D>
PairOperator<D> make(const OperatorSetup<D>& setup) {
  PairOperator<D> op;
  if (!start_closure(setup, op)) return op;
  make_compatible(setup.particles, setup.pairs, setup.method.compatible_iterations, op);
  make_matrices(setup, true, op);  // linear exactness of the vectors as stored
  return op;
}

}  // namespace

OperatorEntry compatible_entry() {
  return {.name = "compatible",
          .line = "linear exactness, closure and energy conjugacy at once: accurate on irregular clouds too",
          .make = {make<1>, make<2>, make<3>},
          .traits = {.areas = true, .adjoint = true, .rough_limit = 0.35},
          .parameters = {closure_iterations()}};
}

#define TAUT_INSTANTIATE(D)                                                                 \
  template bool is_closed<D>(const Particles<D>&, const PairList&, const PairOperator<D>&); \
  template bool start_closure<D>(const OperatorSetup<D>&, PairOperator<D>&);                \
  template double make_compatible<D>(const Particles<D>&, const PairList&, int, PairOperator<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
