#pragma once
/// \file
/// Makers of the formulations, each defined in its own file.

#include <memory>
#include <taut/core/formulation.hpp>

namespace taut {

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
