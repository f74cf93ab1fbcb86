#pragma once
/// \file
/// Rigid motions that nothing holds.

#include <span>
#include <taut/boundary/constraints.hpp>
#include <taut/boundary/loads.hpp>
#include <taut/boundary/mirror.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

/// What the rigid motions of bodies are judged by.
template <int D>
struct Support {
  const Particles<D>& particles;
  const std::vector<Index>& bodies;  ///< number of each particle's body
  const Constraints<D>& constraints;
  const Loads<D>& loads;
  const std::vector<typename MirrorMap<D>::Plane>& planes;
  const std::vector<typename MirrorMap<D>::Period>& periods;
  double reach;                   ///< farthest neighbour [m]
  std::span<const double> times;  ///< at which loads are asked for [s]
};

/// \throws InputError when the loads set a body in a rigid motion that neither constraints nor symmetry
/// planes hold, so that it has no equilibrium: which body, and which motions are free. Motions that are free
/// but not excited are none of its business, nor is a turn of up to 0.2 rad that the loads themselves end:
/// those of a bar that is pulled at both ends, hardly out of line.
template <int D>
void require_held(const Support<D>& support);

}  // namespace taut
