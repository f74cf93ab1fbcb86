#pragma once
/// \file
/// Scalars of a stress, for output. They take the whole, three-dimensional stress: in plane strain the one
/// out of the plane is not zero (see `Simulation::full_cauchy_stress`).

#include <taut/base/types.hpp>

namespace taut {

/// sqrt(3/2 s:s) of the deviator s [Pa]: the uniaxial stress of the same distortional energy (von Mises
/// 1913).
double von_mises(const Mat<3>& sigma);
/// -tr(sigma) / 3 [Pa], positive in compression.
double pressure(const Mat<3>& sigma);
/// Eigenvalues of the symmetric part, largest first [Pa]; all NaN where a component is not finite.
Vec<3> principal_stresses(const Mat<3>& sigma);

}  // namespace taut
