#include <fmt/format.h>

#include <taut/base/error.hpp>
#include <taut/materials/registry.hpp>

namespace taut {

// Of each material, in its own file.
MaterialEntry linear_elastic_entry();
MaterialEntry st_venant_kirchhoff_entry();
MaterialEntry corotated_svk_entry();
MaterialEntry neo_hookean_entry();
MaterialEntry hypoelastic_entry();

Registry<MaterialEntry>& material_registry() {
  static Registry<MaterialEntry> all(
      "material", {linear_elastic_entry(), st_venant_kirchhoff_entry(), corotated_svk_entry(),
                   neo_hookean_entry(), hypoelastic_entry()});
  return all;
}

const char* describe(MaterialKind kind) {
  return kind == MaterialKind::stress ? "a hyperelastic material" : "a material that gives stress rates";
}

template <int D>
MaterialKind kind_of(const Material<D>& material) {
  if (dynamic_cast<const Hyperelastic<D>*>(&material)) return MaterialKind::stress;
  if (dynamic_cast<const Hypoelastic<D>*>(&material)) return MaterialKind::rate;
  throw InputError(
      fmt::format("the material \"{}\" is neither Hyperelastic nor Hypoelastic", material.name()));
}

std::vector<Parameter> parameters_of(const MaterialEntry& entry) {
  std::vector<Parameter> all = {
      required_number("E", Interval::positive(), "Pa", "Young's modulus"),
      required_number("nu", {-1, 0.5, true, true}, "", "Poisson's ratio"),
      required_number("density", Interval::positive(), "kg/m³", "reference density"),
      choice_parameter("plane", "strain",
                       entry.traits.plane_stress ? std::vector<std::string>{"strain", "stress"}
                                                 : std::vector<std::string>{"strain"},
                       "how a 2D body treats the third direction")};
  all.insert(all.end(), entry.parameters.begin(), entry.parameters.end());
  return all;
}

std::vector<std::string> material_names() { return material_registry().names(); }

std::vector<std::string> material_names(MaterialKind kind) {
  std::vector<std::string> names;
  for (const MaterialEntry& entry : material_registry().entries())
    if (entry.traits.kind == kind) names.push_back(entry.name);
  return names;
}

template <int D>
std::shared_ptr<const Material<D>> make_material(std::string_view name,
                                                 const MaterialParameters& parameters) {
  const MaterialEntry& entry = material_registry().find(name);
  const auto& make = maker_of<D>(entry, "material");
  try {
    if (D == 2 && parameters.plane == Plane::stress && !entry.traits.plane_stress)
      throw InputError("it has no law for plane stress");
    MaterialParameters complete = parameters;
    complete_parameters(complete.other, entry.parameters, "it");
    return make(complete);
  } catch (const InputError& error) {
    throw InputError(fmt::format("material '{}': {}", name, error.what()));
  }
}

#define TAUT_INSTANTIATE(D)                             \
  template MaterialKind kind_of<D>(const Material<D>&); \
  template std::shared_ptr<const Material<D>> make_material<D>(std::string_view, const MaterialParameters&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
