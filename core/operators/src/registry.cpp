#include <taut/operators/operator_entries.hpp>

namespace taut {

Registry<OperatorEntry>& operator_registry() {
  static Registry<OperatorEntry> all("operators", {standard_entry(), corrected_entry(), compatible_entry(),
                                                   antisymmetric_entry(), quadratic_entry()});
  return all;
}

const OperatorTraits& operator_traits(std::string_view name) { return operator_registry().find(name).traits; }

std::vector<std::string> operator_names() { return operator_registry().names(); }

Parameter closure_iterations() {
  return whole_parameter("compatible_iterations", 20, 0, 1000000,
                         "iterations of the closure, once at set-up; 10 to 20 keep all of the gain");
}

}  // namespace taut
