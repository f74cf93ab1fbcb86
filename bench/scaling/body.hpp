#pragma once
/// \file
/// The bodies whose steps are timed: cubes of particles, by what they cost.

#include <cstdint>
#include <taut/geometry/geometry.hpp>
#include <vector>

namespace taut::bench {

enum class Arrangement {
  lattice,  ///< cell-centred, square
  jittered  ///< the same, inner particles moved by up to 0.2 spacings along each axis
};
const char* to_string(Arrangement arrangement);

/// A cube of unit edge with round(particles^(1/D)) particles along it.
template <int D>
Cloud<D> cube(std::int64_t particles, Arrangement arrangement);

/// Radii that give particles inside a cube a certain number of neighbours: exactly on a lattice, in the mean
/// where jittered.
struct Neighbourhood {
  int neighbours;
  double support_dx;
  double skin;  ///< of updated Lagrangian lists: none that adds a neighbour on a lattice
};
/// The counts that a lattice of D dimensions can have. In 3D: 18, 32, 56, 80.
template <int D>
const std::vector<Neighbourhood>& neighbourhoods(Arrangement arrangement);
/// \throws InputError listing the valid counts.
template <int D>
const Neighbourhood& neighbourhood(int neighbours, Arrangement arrangement);

}  // namespace taut::bench
