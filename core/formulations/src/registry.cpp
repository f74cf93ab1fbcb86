#include <taut/formulations/formulations.hpp>

namespace taut {

Registry<FormulationEntry>& formulation_registry() {
  // "auto" is the choice between them.
  static Registry<FormulationEntry> all(
      "formulation",
      {tl_displacement_entry(), tl_bond_associated_entry(), tl_stress_points_entry(), ul_basic_entry(),
       ul_artificial_stress_entry()},
      {"auto"});
  return all;
}

const FormulationTraits& formulation_traits(std::string_view name) {
  return formulation_registry().find(name).traits;
}

std::vector<std::string> formulation_names() { return formulation_registry().names(); }

}  // namespace taut
