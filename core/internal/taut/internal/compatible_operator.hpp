#pragma once
/// \file
/// The compatible operator: linear exactness, closure and energy conjugacy at once.

#include <taut/core/kernel.hpp>
#include <taut/core/operators.hpp>

namespace taut {

/// Changes the pair vectors of a corrected operator by the least amount (weighted by the kernel squared) that makes a
/// constant stress free of force inside the body:
///   minimise sum_ab |dG_ab|^2 / w_ab^2   subject to   sum_b X_ab (x) G_ab = V_a I,   sum_b (G_ab - G_ba) = -B_a,
/// where B_a is the outward boundary area vector. With multipliers mu_a (a matrix) and lambda_a (a vector),
///   dG_ab = w_ab^2 (mu_a X_ab + lambda_a - lambda_b),
/// and mu_a follows from the lambdas particle by particle, so linear fields stay exact whenever the iteration for lambda (conjugate
/// gradients with the diagonal as preconditioner) is stopped. The system is as ill-conditioned as a biharmonic, but its smooth modes
/// matter little: `iterations` of 20 to 40 keep nearly all of the gain.
///
/// Expects `op` as `corrected` made it with stored vectors, and writes its vectors and adjoint vectors.
/// \throws InputError when the particles have no boundary area vectors, or these do not close.
/// \returns |closure residual| / |closure residual before|.
template <int D>
double make_compatible(const Particles<D>& particles, const PairList& pairs, const Kernel& kernel, double smoothing_length,
                       int iterations, PairOperator<D>& op);

}  // namespace taut
