#include <fmt/format.h>

#include <algorithm>
#include <lib/auto_rules.hpp>
#include <lib/build.hpp>

namespace taut::bench {
namespace {

bool always(const AutoFacts&) { return true; }
bool rates(const AutoFacts& f) { return f.rate_law; }
bool on_cells(const AutoFacts& f) { return !f.rate_law && f.cells && !f.asks_for_pairs; }
bool on_pairs(const AutoFacts& f) { return !f.rate_law && !on_cells(f); }
bool on_faces(const AutoFacts& f) {
  return on_pairs(f) && !f.from_file && f.box && !f.jittered && !f.inside;
}
bool inside(const AutoFacts& f) { return on_pairs(f) && f.inside; }
bool nearly_incompressible(const AutoFacts& f) { return f.nu >= 0.45 && !f.free_thickness; }
bool may_lock(const AutoFacts& f) { return nearly_incompressible(f) && !on_cells(f); }
bool short_steps(const AutoFacts& f) { return nearly_incompressible(f) && on_cells(f); }

void set(Method& m, const std::string& key, const std::string& value) {
  if (key == "formulation") m.formulation = value;
  if (key == "operators") m.operators = value;
  if (key == "kernel") m.kernel = value;
  if (key == "velocity_gradient") m.velocity_gradient = value;
  if (key == "support_dx") m.support_dx = std::stod(value);
  if (key == "zero_energy_control") m.zero_energy_control = std::stod(value);
}

bool has_rate_law(const std::string& model, MaterialParameters parameters) {
  // Which family a law belongs to does not depend on the dimension.
  return dynamic_cast<const Hypoelastic<3>*>(make_material<3>(model, parameters).get()) != nullptr;
}

}  // namespace

const std::vector<AutoRule>& auto_rules() {
  static const std::vector<AutoRule> rules = {
      {"formulation", "ul_artificial_stress", "the material gives stress rates", rates,
       "rates are integrated in the current configuration; without artificial stress particles clump in "
       "tension"},
      {"formulation", "tl_stress_points", "stresses from the deformation, on a node-centred lattice",
       on_cells,
       "cantilever at -250 N, dx 2 mm: tip off by 0.01 % on the lattice and 0.1 % jittered, in less time and "
       "memory than any operator on pairs. Not where the run gives keys of pairs (`operators`, `kernel`, "
       "`support_dx`, `neighbours`, `pair_precision`)"},
      {"formulation", "tl_displacement", "stresses from the deformation, on other particles", on_pairs,
       "neighbours are found once, and there is no tensile instability"},
      {"operators", "corrected", "a plain node-centred lattice in a box", on_faces,
       "equal to `compatible` there, with the cheaper set-up"},
      {"operators", "compatible", "other particles", on_pairs,
       "a constant stress balances its tractions on any cloud, through facets where particles lie inside of the "
       "surface; `corrected` does not converge on irregular ones"},
      {"kernel", "sinc5", "the material gives stress rates", rates,
       "the kernel that the updated Lagrangian scenes were measured with"},
      {"kernel", "lucy", "particles lie inside of the surface: a cell-centred lattice, centroids from a file", inside,
       "cantilever 8 and 16 cells high, centroids jittered by a quarter of their spacing: tip off by 5.4 and 1.2 %, "
       "`quadratic` by 7.3 and 1.8 %; `wendland_c2` by 3.6 and 0.6 %, but its steps are half as long on irregular clouds"},
      {"kernel", "quadratic", "`tl_displacement` on other particles", on_pairs,
       "cantilever at -250 N, dx 2 mm: tip off by 0.7 % on the lattice and 0.2 % jittered, `wendland_c2` by "
       "1.7 % on both, for the same work"},
      {"support_dx", "2.4", "the material gives stress rates", rates,
       "particles change neighbours: fewer would leave gaps"},
      {"support_dx", "1.5", "`tl_displacement`", on_pairs,
       "the fewest neighbours that linear exactness needs; 2.4 is slower and less accurate"},
      {"zero_energy_control", "1", "`tl_stress_points`", on_cells,
       "cells bend as a beam does; without it they fold up like an hourglass"},
      {"zero_energy_control", "0", "else", always, "adds stiffness whose strength the result depends on"},
      {"velocity_gradient", "corrected", "the material gives stress rates", rates,
       "linearly exact, so that rotation makes no stress"},
      {"formulation", "", "nu of 0.45 or more where the thickness is not free, on pairs", may_lock,
       "displacements alone lock as nu nears 0.5 (too stiff until dx is small), and the step shrinks as "
       "sqrt(1 - 2 nu); there is no mixed form, so the one above is used anyway"},
      {"formulation", "", "nu of 0.45 or more where the thickness is not free, on cells", short_steps,
       "one stress a cell does not lock (cantilever in plane strain, nu 0.49, dx 4 mm: 0.7 % from its limit, "
       "`corrected` operators 12 %), but the step shrinks as sqrt(1 - 2 nu)"},
  };
  return rules;
}

AutoFacts facts_of(const Scene& scene, const RunSpec& run, const std::set<std::string>& given) {
  AutoFacts facts;
  const MaterialSpec material = material_of(scene, run, {});
  facts.rate_law = has_rate_law(material.model, material.parameters);
  facts.from_file = scene.geometry.type == "csv";
  facts.box = scene.geometry.type == "box";
  facts.jittered = run.lattice.jitter > 0;
  facts.inside = facts.from_file ? has_centroids(scene) : run.lattice.kind == Lattice::cell_centred;
  facts.cells = !facts.from_file && run.lattice.kind == Lattice::node_centred;
  for (const char* key : {"operators", "kernel", "support_dx", "neighbours", "pair_precision"})
    facts.asks_for_pairs |= given.contains(key);
  facts.free_thickness =
      scene.dimension == 1 || (scene.dimension == 2 && material.parameters.plane == Plane::stress);
  facts.nu = material.parameters.nu;
  for (const auto& [key, values] : scene.sweep)
    if (key == "nu") facts.nu = *std::max_element(values.begin(), values.end());
  return facts;
}

std::vector<FiredRule> apply_auto_rules(const AutoFacts& facts, const std::set<std::string>& given,
                                        Method& method) {
  std::vector<FiredRule> fired;
  std::set<std::string> done;
  for (const AutoRule& rule : auto_rules()) {
    if (!rule.applies(facts)) continue;
    const std::string value = rule.value;
    if (value.empty()) {
      fired.push_back({"", rule.when, rule.why});
      continue;
    }
    if (!done.insert(rule.key).second) continue;
    if (given.contains(rule.key)) {
      fired.push_back({fmt::format("{} as given", rule.key), "the run gives it", "a run's own keys win"});
      continue;
    }
    set(method, rule.key, value);
    fired.push_back({fmt::format("{} = {}", rule.key, value), rule.when, rule.why});
  }
  return fired;
}

}  // namespace taut::bench
