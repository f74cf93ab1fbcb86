#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/formulations/registry.hpp>
#include <taut/operators/registry.hpp>

namespace taut {
namespace {

bool always(const AutoFacts&) { return true; }
bool rates(const AutoFacts& f) { return f.rate_law; }
bool on_cells(const AutoFacts& f) { return !f.rate_law && f.cells && !f.asks_for_pairs; }
bool on_pairs(const AutoFacts& f) { return !f.rate_law && !on_cells(f); }
bool inside(const AutoFacts& f) { return on_pairs(f) && f.inside; }
// The neighbours of every particle span the space within a tenth of this, not within less.
template <int Tenths>
bool wide(const AutoFacts& f) {
  return on_pairs(f) && f.support > 0.1 * Tenths - 0.05 && f.support < 0.1 * Tenths + 0.05;
}
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
      {"operators", "compatible", "`tl_displacement`", on_pairs,
       "a constant stress balances its tractions on any cloud, through facets where particles lie inside of "
       "the "
       "surface; `corrected` does not converge on irregular ones. On node-centred lattices in boxes they are "
       "`corrected` ones, "
       "as light as those"},
      {"kernel", "sinc5", "the material gives stress rates", rates,
       "the kernel that the updated Lagrangian scenes were measured with"},
      {"kernel", "lucy", "particles lie inside of the surface: a cell-centred lattice, centroids from a file",
       inside,
       "cantilever 8 and 16 cells high, centroids jittered by a quarter of their spacing: tip off by 5.4 and "
       "1.2 %, "
       "`quadratic` by 7.3 and 1.8 %; `wendland_c2` by 3.6 and 0.6 %, but its steps are half as long on "
       "irregular clouds"},
      {"kernel", "quadratic", "`tl_displacement` on other particles", on_pairs,
       "cantilever at -250 N, dx 2 mm: tip off by 0.7 % on the lattice and 0.2 % jittered, `wendland_c2` by "
       "1.7 % on both, for the same work"},
      {"support_dx", "2.4", "the material gives stress rates", rates,
       "particles change neighbours: fewer would leave gaps"},
      {"support_dx", "1.7",
       "particles of an irregular cloud whose neighbours within 1.5 dx do not span the space", wide<17>,
       "with 1.5 one of them would weigh few neighbours by large numbers: a cantilever of 1280 relaxed "
       "points "
       "had no equilibrium within 100000 steps, with 1.7 it is 1.6 % off in 9060"},
      {"support_dx", "2.0", "within 1.7 dx neither", wide<20>, "likewise"},
      {"support_dx", "2.4", "within 2 dx neither", wide<24>, "likewise"},
      {"support_dx", "2.8", "within 2.4 dx neither", wide<28>, "likewise"},
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

const std::vector<std::string>& pair_keys() {
  static const std::vector<std::string> keys = {"operators", "kernel", "support_dx", "neighbours",
                                                "pair_precision"};
  return keys;
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

template <int D>
bool lies_inside(const Cloud<D>& cloud) {
  try {
    Cloud<D> enclosed;
    const bool find = cloud.facets.empty() && !cloud.body;  // a lattice's areas lie on its particles
    if (find) {
      enclosed = cloud;
      if (cloud.B.empty())
        enclose_cloud(enclosed);
      else
        place_areas(enclosed);
    }
    const Cloud<D>& known = find ? enclosed : cloud;
    double depth = 0, total = 0;
    for (const Facet<D>& f : known.facets) {
      depth += (f.centre - known.X[static_cast<std::size_t>(f.owner)]).dot(f.area);
      total += f.area.norm();
    }
    return depth > 0.15 * cloud.dx * total;
  } catch (const InputError&) {
    return false;  // said by what needs the facets
  }
}

Method with_defaults(Method m) {
  settle_parameters(m);
  if (m.formulation == "auto") m.formulation = "tl_displacement";
  if (m.operators.empty()) m.operators = "corrected";
  if (m.kernel.empty()) m.kernel = "wendland_c2";
  if (m.support_dx != 0) return m;
  // Names that are none are for others to refuse.
  const FormulationEntry* formulation = formulation_registry().look_up(m.formulation);
  const OperatorEntry* operators = operator_registry().look_up(m.operators);
  if (formulation) m.support_dx = formulation->traits.support_dx;
  if (operators && (!formulation || formulation->traits.operators))
    m.support_dx = std::max(m.support_dx, operators->traits.support_dx);
  return m;
}

template <int D>
Method complete(const Method& given_method, const Cloud<D>& cloud, const Material<D>& material) {
  const Method open;
  Method method = given_method;
  settle_parameters(method);
  AutoFacts facts;
  facts.asks_for_pairs = !method.operators.empty() || !method.kernel.empty() || method.support_dx != 0 ||
                         method.neighbours != open.neighbours || method.pair_precision != open.pair_precision;
  facts.rate_law = kind_of(material) == MaterialKind::rate;
  if (method.formulation != "auto" || (facts.asks_for_pairs && !facts.rate_law)) return with_defaults(method);
  facts.cells = !cloud.cells.empty();
  facts.inside = !facts.cells && !facts.rate_law && lies_inside(cloud);
  if (!facts.cells && !facts.rate_law) facts.support = spanning_support(cloud);
  facts.nu = material.parameters().nu;
  facts.free_thickness = D == 1 || (D == 2 && material.parameters().plane == Plane::stress);
  std::set<std::string> given;
  if (method.zero_energy_control) given.insert("zero_energy_control");
  if (!method.operators.empty()) given.insert("operators");
  if (!method.kernel.empty()) given.insert("kernel");
  if (method.support_dx != 0) given.insert("support_dx");
  Method chosen = method;
  apply_auto_rules(facts, given, chosen);
  return with_defaults(chosen);
}

#define TAUT_INSTANTIATE(D)                      \
  template bool lies_inside<D>(const Cloud<D>&); \
  template Method complete<D>(const Method&, const Cloud<D>&, const Material<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
