#pragma once
/// \file
/// The volume of a shape by sampling.

#include <taut/geometry/geometry.hpp>

namespace taut {

/// Volume of a shape [m^D] from random points, four a lattice cell (`cells` of them in the bounding box),
/// 4096 to 65536 in all, evenly spread: exact for boxes, else to some 0.1 %. Random, so that slits and holes
/// that lie between the points of any lattice count for what they are. Same points, same answer on every
/// machine.
template <int D>
double estimate_volume(const Shape<D>& shape, double cells);

}  // namespace taut
