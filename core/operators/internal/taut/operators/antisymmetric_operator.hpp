#pragma once
/// \file
/// The antisymmetric operator: as compatible, at the cost of corrected.

#include <functional>
#include <taut/operators/operators.hpp>

namespace taut {

/// Changes the pair vectors g_ab of a corrected operator so that it is all but closed (see `make_compatible`)
/// while they stay antisymmetric, g_ba = -g_ab: nothing is stored beside them, and a step costs what it costs
/// with `corrected`. Closure and conjugacy need only the antisymmetric part of G_ab = V_a M_a g_ab, but its
/// matrices M_a, which make linear fields exact, follow from the vectors. So in sweeps: five iterations for
/// the least change dG that closes what is left, its antisymmetric part
///   dg_ab = 1/2 (mu_a + mu_b) X_ab + lambda_a - lambda_b
/// added to the vectors, and the matrices made anew. V_a M_a comes near I, hence the divergence near linear
/// exactness too: errors on jittered clouds are smaller than those of `compatible`. Other than that, the
/// sweeps have no end to converge to: at R = 1.5 dx a jittered cloud has too few pairs for vectors that are
/// antisymmetric, closed and exact at once.
///
/// Expects `op` as `corrected` made it with stored vectors; `make_matrices` makes M from the vectors of `op`.
/// \throws InputError when the particles have no boundary area vectors, or these do not close.
template <int D>
void make_antisymmetric(const Particles<D>& particles, const PairList& pairs, int iterations,
                        PairOperator<D>& op, const std::function<void()>& make_matrices);

}  // namespace taut
