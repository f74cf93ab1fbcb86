#pragma once
/// \file
/// The registry of formulations.

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <taut/base/parameters.hpp>
#include <taut/base/registry.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/materials/registry.hpp>
#include <vector>

namespace taut {

/// Which configuration the gradients are taken in.
enum class Reference {
  total,   ///< the one at the start: neighbours are found once
  updated  ///< the present one
};

/// Where stresses are made.
enum class StressAt { particles, bonds, cells };

/// What a formulation makes of particles where materials meet.
enum class MaterialsMeet {
  in_particles,  ///< a particle is of one material
  in_twins,      ///< a particle has a twin for each material, and pairs that do not leave it
  in_cells       ///< materials are the cells'; a particle has mass of each
};

/// What the rest of taut knows of a formulation.
struct FormulationTraits {
  Reference reference = Reference::total;
  StressAt stress = StressAt::particles;
  bool pairs = true;      ///< works on pairs of neighbours, found with a kernel's support
  bool operators = true;  ///< takes gradient operators by name (`Method::operators`)
  bool cells = false;     ///< needs the cells of the cloud
  bool areas = false;     ///< needs boundary area vectors, whatever its operators
  MaterialKind material = MaterialKind::stress;  ///< what its materials give
  MaterialsMeet materials = MaterialsMeet::in_particles;
  bool energy = true;              ///< has a stored energy, of materials that have one
  double zero_energy_control = 0;  ///< where none is given
  double support_dx = 1.5;         ///< support radius over spacing where none is given
};

template <int D>
using FormulationMaker = std::function<std::unique_ptr<Formulation<D>>(const FormulationSetup<D>&)>;

/// A formulation by its name. A new one is one file with a class and an entry; see
/// tests/extension/formulation.cpp.
struct FormulationEntry {
  std::string name;
  std::string line;   ///< what it is
  std::string fails;  ///< where it fails
  PerDimension<FormulationMaker> make;
  FormulationTraits traits{};
  /// Of `Method`: members that it reads, others in `Method::parameters`. Those of its operators come on top.
  std::vector<Parameter> parameters{};
};

/// All formulations; programs may add theirs.
Registry<FormulationEntry>& formulation_registry();
/// Traits by name. \throws InputError listing the valid names.
const FormulationTraits& formulation_traits(std::string_view name);

/// `operators` (where it takes them), `kernel`, `support_dx`, `neighbours` and `pair_precision`, for the
/// table of a formulation on pairs.
std::vector<Parameter> pair_parameters(const FormulationTraits& traits);
/// The parameters of a formulation, with those of the operators where it takes some.
std::vector<Parameter> parameters_of(std::string_view formulation, std::string_view operators);
/// What the method of a simulation is to be: parameters that have names of members are there, those that are
/// left open have their defaults. \throws InputError for unknown names, parameters that the formulation and
/// its operators do not have, or values out of range, listing what is valid.
Method checked_method(Method method);

/// Whether a method needs the boundary area vectors of the cloud, and acts through its facets.
bool needs_areas(const Method& method);

/// What makes formulations of a class template that is constructed from `FormulationSetup`.
template <template <int> class Form>
PerDimension<FormulationMaker> formulation_makers() {
  return {[](const FormulationSetup<1>& s) -> std::unique_ptr<Formulation<1>> {
            return std::make_unique<Form<1>>(s);
          },
          [](const FormulationSetup<2>& s) -> std::unique_ptr<Formulation<2>> {
            return std::make_unique<Form<2>>(s);
          },
          [](const FormulationSetup<3>& s) -> std::unique_ptr<Formulation<3>> {
            return std::make_unique<Form<3>>(s);
          }};
}

}  // namespace taut
