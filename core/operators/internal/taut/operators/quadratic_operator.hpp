#pragma once
/// \file
/// The quadratic operator: gradients of quadratic fields are exact at every particle.

#include <string>
#include <taut/kernels/kernel.hpp>
#include <taut/operators/operators.hpp>

namespace taut {

/// Stores the pair vectors of moving least squares through the particle itself (Liszka & Orkisz 1980),
///   G_ab = V_a W_ab C_a p(X_ab),   p = (X_i / dx, X_i X_j / dx^2, i <= j),
/// with C_a the rows for X_i of [sum_b W_ab p p^T]^-1, over dx: so sum_b X_ab (x) G_ab = V_a I and
/// sum_b (X_ab)_i (X_ab)_j G_ab = 0. They are not antisymmetric, hence -G_ba is stored beside them. They do
/// not close: a constant stress makes forces wherever the vectors of neighbours differ.
///
/// Expects `op` with its precision, single or double.
/// \throws InputError for a particle whose neighbours do not determine a quadratic.
template <int D>
void make_quadratic(const Particles<D>& particles, const PairList& pairs, const Kernel& kernel,
                    double smoothing_length, PairOperator<D>& op);

}  // namespace taut
