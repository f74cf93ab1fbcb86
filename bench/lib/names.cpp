#include <lib/names.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/kernels/registry.hpp>
#include <taut/materials/registry.hpp>
#include <taut/neighbors/registry.hpp>
#include <taut/operators/registry.hpp>

namespace taut::bench {
namespace {

const FormulationTraits* traits_of(const std::string& formulation) {
  const FormulationEntry* entry = formulation_registry().look_up(formulation);
  return entry ? &entry->traits : nullptr;
}

void add_new(std::vector<Parameter>& all, const std::vector<Parameter>& more) {
  for (const Parameter& p : more)
    if (!find_parameter(all, p.name)) all.push_back(p);
}

}  // namespace

Names names() {
  return {formulation_names(), operator_names(),          Kernel::names(),
          material_names(),    search_registry().names(), integrator_names()};
}

bool has_pairs(const std::string& formulation) {
  const FormulationTraits* traits = traits_of(formulation);
  return !traits || traits->pairs;
}

bool has_operators(const std::string& formulation) {
  const FormulationTraits* traits = traits_of(formulation);
  return traits && traits->operators;
}

bool is_updated(const std::string& formulation) {
  const FormulationTraits* traits = traits_of(formulation);
  return traits && traits->reference == Reference::updated;
}

bool has_parameter(const std::string& formulation, const std::string& parameter) {
  const FormulationEntry* entry = formulation_registry().look_up(formulation);
  return entry && find_parameter(entry->parameters, parameter);
}

double default_support(const std::string& formulation, const std::string& operators) {
  return with_defaults({.formulation = formulation, .operators = operators}).support_dx;
}

double default_control(const std::string& formulation) {
  const FormulationTraits* traits = traits_of(formulation);
  return traits ? traits->zero_energy_control : 0;
}

int exactness(const std::string& operators) {
  const OperatorEntry* entry = operator_registry().look_up(operators);
  return entry ? entry->traits.exact : -1;
}

std::vector<Parameter> method_parameters() {
  std::vector<Parameter> all;
  for (const FormulationEntry& entry : formulation_registry().entries()) add_new(all, entry.parameters);
  for (const OperatorEntry& entry : operator_registry().entries()) add_new(all, entry.parameters);
  return all;
}

std::vector<Parameter> material_parameters() {
  std::vector<Parameter> all;
  for (const MaterialEntry& entry : material_registry().entries()) add_new(all, parameters_of(entry));
  return all;
}

}  // namespace taut::bench
