#include <fmt/format.h>

#include <algorithm>
#include <taut/base/error.hpp>
#include <taut/formulations/registry.hpp>
#include <taut/kernels/registry.hpp>
#include <taut/neighbors/registry.hpp>
#include <taut/operators/registry.hpp>

namespace taut {

namespace {

// A parameter whose values are the names of a registry, those that programs add included.
Parameter name_parameter(const char* name, const char* fallback, std::vector<std::string> (*names)(),
                         const char* line) {
  return {
      .name = name, .type = Parameter::Type::choice, .fallback = fallback, .choices = names, .line = line};
}

std::vector<std::string> search_names() { return search_registry().names(); }

// The first table that has a parameter: what it must be where the formulation at hand has no use for it.
const Parameter* find_anywhere(std::string_view name) {
  for (const FormulationEntry& entry : formulation_registry().entries())
    if (const Parameter* p = find_parameter(entry.parameters, name)) return p;
  for (const OperatorEntry& entry : operator_registry().entries())
    if (const Parameter* p = find_parameter(entry.parameters, name)) return p;
  return nullptr;
}

}  // namespace

std::vector<Parameter> pair_parameters(const FormulationTraits& traits) {
  // Names have no default here: `with_defaults` and the rules of `auto` say what stands for them.
  std::vector<Parameter> all;
  if (traits.operators)
    all.push_back(name_parameter("operators", "corrected", operator_names, "gradient operators"));
  all.push_back(name_parameter("kernel", "wendland_c2", Kernel::names, "smoothing kernel"));
  all.push_back(number_parameter("support_dx", traits.support_dx, {1, 20, true, false}, "dx",
                                 traits.operators
                                     ? "support radius of the kernel; at least what the operators take"
                                     : "support radius of the kernel"));
  all.push_back(name_parameter("neighbours", "cell_list", search_names, "how pairs are found"));
  if (traits.operators)
    all.push_back(
        name_parameter("pair_precision", "automatic", pair_precision_names,
                       "how pair vectors are kept: `shared` once for all that are alike (lattices), "
                       "`automatic` is `shared` on lattices and `single` elsewhere; sums are always double"));
  return all;
}

std::vector<Parameter> parameters_of(std::string_view formulation, std::string_view operators) {
  const FormulationEntry& entry = formulation_registry().find(formulation);
  std::vector<Parameter> all = entry.parameters;
  if (!entry.traits.operators) return all;
  for (const Parameter& p : operator_registry().find(operators).parameters)
    if (!find_parameter(all, p.name)) all.push_back(p);
  return all;
}

Method checked_method(Method method) {
  settle_parameters(method);
  formulation_registry().find(method.formulation);
  // Names are checked when they are given, whether or not this formulation looks at them.
  operator_registry().find(method.operators);
  kernel_registry().find(method.kernel);
  search_method(method.neighbours);
  if (*to_string(method.pair_precision) == '\0')
    throw InputError(fmt::format("pair_precision: the value {} of PairPrecision has no name; valid: {}",
                                 static_cast<int>(method.pair_precision),
                                 join_names(pair_precision_names())));
  const std::vector<Parameter> table = parameters_of(method.formulation, method.operators);
  const std::string owner = fmt::format("formulation \"{}\"", method.formulation);
  for (const char* name :
       {"support_dx", "compatible_iterations", "zero_energy_control", "viscosity", "skin",
        "velocity_gradient", "artificial_stress", "artificial_stress_exponent", "artificial_stress_weight"}) {
    const auto value = given_parameter(method, name);
    const Parameter* own = find_parameter(table, name);
    const Parameter* known = own ? own : find_anywhere(name);
    if (value && known) known->check(*value);
  }
  // A member that does nothing is no mistake, but for one that would have to do something.
  if (method.zero_energy_control.value_or(0) > 0 && !find_parameter(table, "zero_energy_control"))
    throw InputError(
        fmt::format("{} has no zero-energy modes to control: zero_energy_control must be 0", owner));
  std::vector<Parameter> others;
  for (const Parameter& p : table)
    if (!is_member(p.name)) others.push_back(p);
  for (const auto& [name, value] : method.parameters)
    if (!find_parameter(others, name))
      throw InputError(fmt::format("{} has no parameter \"{}\"; it has: {}", owner, name,
                                   table.empty() ? "none" : join_names(parameter_names(table))));
  complete_parameters(method.parameters, others, owner);
  return method;
}

bool needs_areas(const Method& method) {
  const FormulationTraits& traits = formulation_traits(method.formulation);
  return traits.areas || (traits.operators && operator_traits(method.operators).areas);
}

}  // namespace taut
