#pragma once
/// \file
/// Pair vectors kept once for all slots that are alike.

#include <taut/kernels/kernel.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/operators.hpp>
#include <taut/particles/particles.hpp>

namespace taut {

/// Offsets and matrices that differ by less than this, relative to the support radius or the size of the
/// largest entry, count as equal: well above the rounding of a lattice's coordinates, well below anything
/// meant.
inline constexpr double alike = 1e-10;

/// Fraction of the slots, in a sample of the list, whose vectors are not those of another slot near by.
/// `weights` are the particles', or empty where all weigh alike.
template <int D>
double distinct_fraction(const Particles<D>& particles, const PairList& pairs, double support,
                         const Field& weights);

/// Fills `slice_slots`, `slots` and `blocks` of an operator whose weights are given.
template <int D>
void share_vectors(const Particles<D>& particles, const PairList& pairs, const Kernel& kernel, double h,
                   PairOperator<D>& op);

}  // namespace taut
