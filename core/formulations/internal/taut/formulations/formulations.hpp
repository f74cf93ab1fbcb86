#pragma once
/// \file
/// Makers of the formulations, each defined in its own file.

#include <memory>
#include <string_view>
#include <taut/formulations/formulation.hpp>

namespace taut {

/// What a formulation makes of particles where materials meet.
enum class MaterialsMeet {
  in_particles,  ///< a particle is of one material
  in_twins,      ///< a particle has a twin for each material, and pairs that do not leave it
  in_cells       ///< materials are the cells'; a particle has mass of each
};
/// Of a formulation by its name, a valid one.
MaterialsMeet materials_meet(std::string_view formulation);

template <int D>
std::unique_ptr<Formulation<D>> make_tl_displacement(const FormulationSetup<D>& setup);
template <int D>
std::unique_ptr<Formulation<D>> make_tl_bond_associated(const FormulationSetup<D>& setup);
template <int D>
std::unique_ptr<Formulation<D>> make_tl_stress_points(const FormulationSetup<D>& setup);
template <int D>
std::unique_ptr<Formulation<D>> make_ul_basic(const FormulationSetup<D>& setup);
template <int D>
std::unique_ptr<Formulation<D>> make_ul_artificial_stress(const FormulationSetup<D>& setup);

}  // namespace taut
