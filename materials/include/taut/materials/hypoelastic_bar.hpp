#pragma once
/// \file
/// Exact solution of a bar of the hypoelastic material, for tests and benches.

#include <optional>
#include <taut/materials/material.hpp>

namespace taut {

/// What holds the sides of a bar.
enum class BarSides {
  free,          ///< no stress on any side: a 3D bar, or a 2D one in plane stress
  plane_strain,  ///< one lateral strain is zero, the other side is free: a 2D bar in plane strain
  confined       ///< no lateral strain: 1D
};

struct HypoelasticBarState {
  double stretch;             ///< current over reference length
  double transverse_stretch;  ///< of the free sides; 1 for a confined bar
  double stress;              ///< axial Cauchy stress [Pa]
  double volume_ratio;        ///< rho0 / rho
};

/// A bar of the `hypoelastic` material at rest under a dead axial load per reference cross section [Pa],
/// positive in tension, reached from the unloaded state without rotation. There Jaumann's rate integrates
/// exactly: with theta = ln(rho0 / rho), p = K (exp(-theta) - 1) and logarithmic strains e, s_i = 2 mu (e_i -
/// theta / 3). A free side has s_t = p, hence e_t = theta / 3 + p / (2 mu); the rest follows, and theta from
/// load = sigma exp(sum of lateral e).
///
/// Nothing where the bar has no such state on the path from rest: with free sides the load in tension has a
/// largest value, unless the material is compressible enough (K / mu below about 3.3). Volume ratios beyond
/// exp(16) are not sought. `parameters.plane` is ignored. \throws InputError for parameters out of range or a
/// load that is not finite.
std::optional<HypoelasticBarState> hypoelastic_bar(const MaterialParameters& parameters, BarSides sides,
                                                   double load);

}  // namespace taut
