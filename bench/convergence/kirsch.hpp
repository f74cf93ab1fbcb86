#pragma once
/// \file
/// A circular hole in a wide plate under tension, exactly (Kirsch 1898).

#include <taut/geometry/geometry.hpp>
#include <taut/materials/material.hpp>

namespace taut::bench {

/// An infinite plate with a hole of radius `a` around the origin, pulled along x by the stress `S` far away.
/// Small strain.
struct KirschPlate {
  double a = 1;  ///< [m]
  double S = 1;  ///< [Pa]
  MaterialParameters material;

  Vec<2> displacement(const Vec<2>& X) const;
  Mat<2> stress(const Vec<2>& X) const;
};

/// A quarter of the ring a ≤ |X| ≤ b, X, Y ≥ 0, on circles one spacing apart with points about one spacing
/// apart: a cloud that follows the hole. Area vectors are those of the polygon through the boundary points,
/// so that they close exactly; volumes are the sectors around the points, scaled to the polygon's area.
Cloud<2> quarter_ring_cloud(double a, double b, double dx);
/// The same body on a lattice, its boundary in steps.
Cloud<2> quarter_ring_lattice(double a, double b, double dx);

}  // namespace taut::bench
