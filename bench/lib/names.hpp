#pragma once
/// \file
/// Names that scene files may use for the parts of the library, and what they can be told.

#include <string>
#include <taut/formulations/registry.hpp>
#include <vector>

namespace taut::bench {

struct Names {
  std::vector<std::string> formulations, operators, kernels, materials, neighbours, integrators;
};

/// What the library's registries hold at this moment.
Names names();

/// Whether a formulation works on pairs of neighbours: kernel and support are then its choices. Stress points
/// have cells instead. True for what is no formulation ("auto").
bool has_pairs(const std::string& formulation);
/// Whether it takes gradient operators by name.
bool has_operators(const std::string& formulation);
/// Whether it is one that takes its gradients in the present configuration.
bool is_updated(const std::string& formulation);
bool has_parameter(const std::string& formulation, const std::string& parameter);
/// The support radius over dx that a run gets when it gives none: the least that its sums need.
double default_support(const std::string& formulation, const std::string& operators);
/// The strength of zero-energy control that a formulation has when none is given.
double default_control(const std::string& formulation);
/// Degree of the polynomials whose gradients are exact; -1 for what is no operator.
int exactness(const std::string& operators);

/// Every parameter that a run may give: those of all formulations and operators, by name; where several have
/// one of that name, as the first has it.
std::vector<Parameter> method_parameters();
/// Every parameter that a material may have.
std::vector<Parameter> material_parameters();

}  // namespace taut::bench
