#pragma once
/// \file
/// The registry of materials.

#include <functional>
#include <memory>
#include <string>
#include <taut/base/parameters.hpp>
#include <taut/base/registry.hpp>
#include <taut/materials/material.hpp>
#include <vector>

namespace taut {

/// What a material gives.
enum class MaterialKind {
  stress,  ///< the stress of a deformation gradient: `Hyperelastic`
  rate     ///< the rate of stress: `Hypoelastic`
};
/// "a hyperelastic material", "a material that gives stress rates".
const char* describe(MaterialKind kind);
/// The kind of a material, whoever made it. \throws InputError for one that is neither.
template <int D>
MaterialKind kind_of(const Material<D>& material);

struct MaterialTraits {
  MaterialKind kind = MaterialKind::stress;
  bool energy = true;        ///< whether its stress is the derivative of a stored energy
  bool plane_stress = true;  ///< whether it has a law for 2D bodies in plane stress
};

template <int D>
using MaterialMaker = std::function<std::unique_ptr<Material<D>>(const MaterialParameters&)>;

/// A material by its name. A new one is one file with a class and an entry; see tests/extension/material.cpp.
struct MaterialEntry {
  std::string name;
  std::string line;  ///< its law
  PerDimension<MaterialMaker> make;
  MaterialTraits traits{};
  std::vector<Parameter> parameters{};  ///< besides E, nu, density and plane; in `MaterialParameters::other`
};

/// All materials; programs may add theirs.
Registry<MaterialEntry>& material_registry();
/// E, nu, density and plane, then those of its own: what scenes may give.
std::vector<Parameter> parameters_of(const MaterialEntry& entry);
/// Names of the materials of a kind.
std::vector<std::string> material_names(MaterialKind kind);

/// What makes materials of a class template that is constructed from `MaterialParameters`.
template <template <int> class Law>
PerDimension<MaterialMaker> material_makers() {
  return {
      [](const MaterialParameters& p) -> std::unique_ptr<Material<1>> { return std::make_unique<Law<1>>(p); },
      [](const MaterialParameters& p) -> std::unique_ptr<Material<2>> { return std::make_unique<Law<2>>(p); },
      [](const MaterialParameters& p) -> std::unique_ptr<Material<3>> {
        return std::make_unique<Law<3>>(p);
      }};
}

}  // namespace taut
