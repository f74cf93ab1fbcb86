#pragma once
/// \file
/// The choices that make a discretisation of a body.

#include <optional>
#include <string>
#include <string_view>
#include <taut/base/parameters.hpp>
#include <taut/operators/pair_precision.hpp>

namespace taut {

/// Formulation, operators and their parameters. Names are those of the registries; each error lists the valid
/// ones. What a formulation and its operators have no use for is not looked at. Their tables
/// (`parameters_of`, formulations/registry.hpp) say which parameters they have, with defaults and ranges.
struct Method {
  /// "auto": chosen for the body, by the rules of auto_method.hpp: stress points where the cloud has cells. A
  /// method that gives operators, a kernel or another key of pairs is `tl_displacement`.
  std::string formulation = "auto";
  std::string operators{};  ///< empty: chosen with the formulation; `corrected` where that is given
  std::string kernel{};     ///< likewise; `wendland_c2`
  /// Support radius over particle spacing, R / dx. Zero: likewise; 1.5, and 2.4 for updated Lagrangian forms
  /// and `quadratic` operators.
  double support_dx = 0;
  std::string neighbours = "cell_list";
  PairPrecision pair_precision = PairPrecision::automatic;

  /// Conjugate-gradient iterations of the set-up of `compatible` and `antisymmetric` operators.
  int compatible_iterations = 20;

  /// Control of zero-energy modes in the total Lagrangian forms, 0 = absent. `tl_displacement`: coefficient
  /// alpha of a pairwise energy, absent unless given,
  ///   1/4 sum_a sum_b k_ab |x_ab - F_a X_ab|^2,   k_ab = alpha E V_a V_b W_ab / |X_ab|^2,
  /// with the stiffness of Ganzenmueller (2015). `tl_stress_points`: stiffness of the hourglass modes over
  /// the one that bends a square cell, or a cube, as a beam does; 1 unless given. Linear motions have none of
  /// either.
  std::optional<double> zero_energy_control{};

  /// Updated Lagrangian forms: Monaghan viscosity alpha (0 = absent), skin of the pair list over R, whether
  /// the velocity gradient is linearly exact ("corrected") or plain ("standard").
  double viscosity = 0;
  double skin = 0.1;
  std::string velocity_gradient = "standard";
  /// Artificial stress (Gray, Monaghan, Swift 2001): factor epsilon, exponent n and the weight: "kernel" for
  /// W(r)/W(dx), "distance" for r/dx (Tran-Duc et al. as printed).
  double artificial_stress = 0.3;
  double artificial_stress_exponent = 4;
  std::string artificial_stress_weight = "kernel";

  /// Parameters that are no members: those of formulations and operators that a program adds. What is not
  /// given has its default once a simulation has the method. Names of members may stand here too.
  ParameterMap parameters{};

  /// A parameter from `parameters`. \throws InputError where there is none.
  double number(std::string_view name) const { return number_of(parameters, name); }
  const std::string& text(std::string_view name) const { return text_of(parameters, name); }
};

/// Whether a member of `Method` has that name.
bool is_member(std::string_view name);
/// Parameter `name` of a method as it is given: the member of that name, else that in `parameters`. Nothing
/// where it is left open.
std::optional<ParameterValue> given_parameter(const Method& method, std::string_view name);
/// \throws InputError for a text where the member is a number, and the other way about; an unknown precision.
void set_parameter(Method& method, std::string_view name, const ParameterValue& value);
/// Moves what stands in `parameters` under the name of a member there.
void settle_parameters(Method& method);

}  // namespace taut
