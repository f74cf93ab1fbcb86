#pragma once
/// \file
/// The choices that make a discretisation of a body.

#include <string>

namespace taut {

/// Number type of the stored pair vectors. State and sums are always double.
enum class PairPrecision { single_precision, double_precision };

/// Formulation, operators and their parameters. Names are those of the registries; each error lists the valid ones.
struct Method {
  std::string formulation = "tl_displacement";
  std::string operators = "corrected";
  std::string kernel = "wendland_c2";
  /// Support radius over particle spacing, R / dx.
  double support_dx = 1.5;
  std::string neighbours = "cell_list";
  PairPrecision pair_precision = PairPrecision::single_precision;

  /// Conjugate-gradient iterations of the set-up of `compatible` operators.
  int compatible_iterations = 40;

  /// Pairwise zero-energy control of the total Lagrangian forms (Ganzenmueller 2015), 0 = absent.
  double zero_energy_control = 0;

  /// Updated Lagrangian forms: Monaghan viscosity alpha (0 = absent), skin of the pair list over R, whether the velocity
  /// gradient is linearly exact ("corrected") or plain ("standard").
  double viscosity = 0;
  double skin = 0.1;
  std::string velocity_gradient = "standard";
  /// Artificial stress (Gray, Monaghan, Swift 2001): factor epsilon, exponent n and the weight: "kernel" for
  /// W(r)/W(dx), "distance" for r/dx (Tran-Duc et al. as printed).
  double artificial_stress = 0.3;
  double artificial_stress_exponent = 4;
  std::string artificial_stress_weight = "kernel";
};

}  // namespace taut
