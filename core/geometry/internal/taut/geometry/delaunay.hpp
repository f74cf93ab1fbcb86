#pragma once
// Delaunay's triangulation of points.

#include <array>
#include <taut/base/types.hpp>
#include <vector>

namespace taut {

template <int D>
using Simplex = std::array<Index, D + 1>;

/// Simplices that fill the convex hull of points in general position: intervals, triangles, tetrahedra, with
/// det [X_1 - X_0, …] > 0. No point lies inside the circumscribed ball of a simplex.
/// \throws InputError for fewer than D + 1 points, or points on one line or plane, and in 2D and 3D when this
/// build has no Qhull.
template <int D>
std::vector<Simplex<D>> delaunay(const std::vector<Vec<D>>& X);

}  // namespace taut
