#pragma once
/// \file
/// A bar in pure bending, known exactly: the 3D bending case of the frontier.

#include <lib/results.hpp>
#include <optional>
#include <taut/simulation/simulation.hpp>

namespace taut::bench {

/// Linear elastic bar of square section, -½ ≤ Y, Z ≤ ½, bent by end moments to the curvature kappa
/// (Timoshenko and Goodier 1970, section 102): u = kappa [-X Y, (X² + nu (Y² - Z²))/2, nu Y Z], whose only
/// stress is P_xX = -E kappa Y. Modelled: 0 ≤ X ≤ 3, Z ≥ 0, both symmetry planes.
class BentBar {
 public:
  static MaterialParameters material();
  static double curvature() { return 1e-4; }  ///< [1/m]
  static double length() { return 3; }
  static Vec<3> displacement(const Vec<3>& X);
  static Mat<3> stress(const Vec<3>& X);
};

struct BentBarRun {
  Row row;                          ///< all columns but quantity
  std::optional<double> tip_error;  ///< relative error of the tip's deflection
};

/// At rest under the end moment, `intervals` (even) across the section. \throws InputError for what the
/// method cannot take.
BentBarRun run_bent_bar(const Method& method, int intervals, double jitter, unsigned seed, int threads);

}  // namespace taut::bench
