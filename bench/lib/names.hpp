#pragma once
/// \file
/// Names that scene files may use for the parts of the library.

#include <string>
#include <vector>

namespace taut::bench {

struct Names {
  std::vector<std::string> formulations, operators, kernels, materials, neighbours, integrators;
};

/// What the library's registries hold.
const Names& names();

/// Whether a formulation works on pairs of neighbours: operators, kernel, support and pair precision are then
/// its choices. Stress points have cells instead.
bool has_pairs(const std::string& formulation);
/// The support radius over dx that a run gets when it gives none: the least that its sums need.
double default_support(const std::string& formulation, const std::string& operators);
/// The strength of zero-energy control that a formulation has when none is given.
double default_control(const std::string& formulation);

}  // namespace taut::bench
