#include <cmath>
#include <taut/base/powers.hpp>
#include <taut/operators/closure_system.hpp>
#include <taut/operators/compatible_operator.hpp>
#include <taut/operators/pair_passes.hpp>
#include <taut/operators/pair_vectors.hpp>

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

template bool is_closed<1>(const Particles<1>&, const PairList&, const PairOperator<1>&);
template bool is_closed<2>(const Particles<2>&, const PairList&, const PairOperator<2>&);
template bool is_closed<3>(const Particles<3>&, const PairList&, const PairOperator<3>&);
template double make_compatible<1>(const Particles<1>&, const PairList&, int, PairOperator<1>&);
template double make_compatible<2>(const Particles<2>&, const PairList&, int, PairOperator<2>&);
template double make_compatible<3>(const Particles<3>&, const PairList&, int, PairOperator<3>&);

}  // namespace taut
