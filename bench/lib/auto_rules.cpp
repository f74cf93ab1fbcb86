#include <algorithm>
#include <lib/auto_rules.hpp>
#include <lib/build.hpp>
#include <taut/materials/registry.hpp>

namespace taut::bench {
AutoFacts facts_of(const Scene& scene, const RunSpec& run, const std::set<std::string>& given) {
  AutoFacts facts;
  const MaterialSpec material = material_of(scene, run, {});
  facts.rate_law = material_registry().find(material.model).traits.kind == MaterialKind::rate;
  const bool from_file = scene.geometry.type == "csv";
  if (from_file)
    add_facts_of_file(scene, facts);
  else
    facts.inside = run.lattice.kind == Lattice::cell_centred;
  facts.cells = !from_file && run.lattice.kind == Lattice::node_centred;
  for (const std::string& key : pair_keys()) facts.asks_for_pairs |= given.contains(key);
  facts.free_thickness =
      scene.dimension == 1 || (scene.dimension == 2 && material.parameters.plane == Plane::stress);
  facts.nu = material.parameters.nu;
  for (const auto& [key, values] : scene.sweep)
    if (key == "nu") facts.nu = *std::max_element(values.begin(), values.end());
  return facts;
}

}  // namespace taut::bench
