#pragma once
/// \file
/// The compatible operator: linear exactness, closure and energy conjugacy at once.

#include <taut/operators/registry.hpp>

namespace taut {

/// Whether a corrected operator is as good as compatible: a unit stress leaves forces of less than 1e-4 of a
/// cell's face inside the body. A node-centred box with a support of 1.5 dx leaves 1e-5, so that its vectors
/// may stay shared; on jittered clouds the iteration below, stopped early, leaves 1e-2 where `corrected`
/// left 2. \throws InputError when the particles have no boundary area vectors, or these do not close.
template <int D>
bool is_closed(const Particles<D>& particles, const PairList& pairs, const PairOperator<D>& op);

/// Changes the pair vectors of a corrected operator by the least amount that makes a constant stress free of
/// force inside the body:
///   minimise sum_ab |dG_ab|^2   subject to   sum_b X_ab (x) G_ab = V_a I,   sum_b (G_ab - G_ba) = -B_a,
/// where B_a is the outward boundary area vector. With multipliers mu_a (a matrix) and lambda_a (a vector),
///   dG_ab = mu_a X_ab + lambda_a - lambda_b,
/// and mu_a follows from the lambdas particle by particle, so linear fields stay exact whenever the iteration
/// for lambda (conjugate gradients with the diagonal as preconditioner) is stopped. The system is as
/// ill-conditioned as a biharmonic, but its smooth modes matter little: 10 to 20 `iterations` keep all of the
/// gain. All pairs count alike: weighing changes by the kernel squared, so that the furthest neighbours keep
/// their vectors, costs four times the iterations and ends with half as much error again.
///
/// Expects `op` as `corrected` made it with stored vectors, and writes its vectors and adjoint vectors.
/// \throws InputError when the particles have no boundary area vectors, or these do not close.
/// \returns |closure residual| / |closure residual before|.
template <int D>
double make_compatible(const Particles<D>& particles, const PairList& pairs, int iterations,
                       PairOperator<D>& op);

/// Makes `op` the corrected operator that closure begins with. False where it is all but closed and nothing
/// is left to do; else its vectors are stored. \throws InputError as `is_closed`, and where they may not be
/// stored.
template <int D>
bool start_closure(const OperatorSetup<D>& setup, PairOperator<D>& op);

}  // namespace taut
