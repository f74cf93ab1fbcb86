#include <fmt/format.h>

#include <taut/base/error.hpp>
#include <taut/materials/material.hpp>

// Every material: one file with TAUT_MATERIAL in it, and one line here.
#define TAUT_MATERIALS(M) \
  M(linear_elastic)       \
  M(st_venant_kirchhoff)  \
  M(corotated_svk)        \
  M(neo_hookean)          \
  M(hypoelastic)

namespace taut {

#define TAUT_DECLARE(name) \
  template <int D>         \
  std::unique_ptr<Material<D>> make_##name(const MaterialParameters& parameters);
TAUT_MATERIALS(TAUT_DECLARE)
#undef TAUT_DECLARE

std::vector<std::string> material_names() {
#define TAUT_NAME(name) #name,
  return {TAUT_MATERIALS(TAUT_NAME)};
#undef TAUT_NAME
}

template <int D>
std::shared_ptr<const Material<D>> make_material(std::string_view name,
                                                 const MaterialParameters& parameters) {
  struct Entry {
    std::string_view name;
    std::unique_ptr<Material<D>> (*make)(const MaterialParameters&);
  };
#define TAUT_ENTRY(name) {#name, make_##name<D>},
  static constexpr Entry entries[] = {TAUT_MATERIALS(TAUT_ENTRY)};
#undef TAUT_ENTRY
  for (const Entry& entry : entries) {
    if (entry.name != name) continue;
    try {
      return entry.make(parameters);
    } catch (const InputError& error) {
      throw InputError(fmt::format("material '{}': {}", name, error.what()));
    }
  }
  throw InputError(fmt::format("no material '{}'; valid names: {}", name, join_names(material_names())));
}

template std::shared_ptr<const Material<1>> make_material<1>(std::string_view, const MaterialParameters&);
template std::shared_ptr<const Material<2>> make_material<2>(std::string_view, const MaterialParameters&);
template std::shared_ptr<const Material<3>> make_material<3>(std::string_view, const MaterialParameters&);

}  // namespace taut
