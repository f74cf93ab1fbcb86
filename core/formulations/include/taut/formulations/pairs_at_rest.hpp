#pragma once
/// \file
/// The neighbours of total Lagrangian forms.

#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/method.hpp>
#include <taut/particles/particles.hpp>

namespace taut {

/// The pairs of particles and their images in the reference configuration, within the supports of a method:
/// without those that the body does not lie between. \throws InputError as `find_pairs`.
template <int D>
PairList find_pairs_at_rest(const Particles<D>& particles, const Method& method);

}  // namespace taut
