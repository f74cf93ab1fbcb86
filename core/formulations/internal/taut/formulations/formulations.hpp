#pragma once
/// \file
/// Entries of taut's own formulations, each defined in the file of what it names.

#include <taut/formulations/registry.hpp>

namespace taut {

FormulationEntry tl_displacement_entry();
FormulationEntry tl_bond_associated_entry();
FormulationEntry tl_stress_points_entry();
FormulationEntry ul_basic_entry();
FormulationEntry ul_artificial_stress_entry();

}  // namespace taut
