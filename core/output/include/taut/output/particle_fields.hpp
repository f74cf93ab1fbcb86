#pragma once
/// \file
/// Fields of all particles at once.

#include <span>
#include <string>
#include <string_view>
#include <taut/simulation/simulation.hpp>
#include <vector>

namespace taut {

/// Names of the fields that `read_field` knows, with their components in D dimensions:
/// - `reference_position`, `position`, `displacement` [m], `velocity` [m/s]: D; `mass` [kg]: 1
/// - `cauchy_stress` [Pa]: 9, row-major, with the axes that the body does not have (NaN where the material
/// does
///   not give them); `von_mises`, `pressure`: 1 and `principal_stress`: 3, largest first, of it [Pa]
/// - `first_piola_kirchhoff` [Pa], `deformation_gradient`: D*D, row-major; `J`, the determinant of the
/// latter: 1
std::vector<std::string> field_names();
/// \throws InputError listing the valid names.
int field_components(std::string_view name, int dimension);

/// Writes a field of the present state, in the user's order: component c of particle i at i * components + c.
/// On all threads, particle by particle what the members of Simulation of these names give. \throws
/// InputError for an unknown name, a span of another size than size() * components, before the simulation is
/// prepared, and for `deformation_gradient` and its like where the formulation has no reference
/// configuration.
template <int D>
void read_field(const Simulation<D>& simulation, std::string_view name, std::span<double> out);
/// The same in a vector.
template <int D>
std::vector<double> read_field(const Simulation<D>& simulation, std::string_view name);

}  // namespace taut
