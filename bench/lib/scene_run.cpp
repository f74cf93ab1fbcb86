#include <fmt/format.h>

#include <lib/names.hpp>
#include <lib/scene_keys.hpp>
#include <lib/scene_parts.hpp>
#include <taut/formulations/registry.hpp>
#include <taut/operators/method.hpp>

namespace taut::bench {
namespace {

/// Those that a run may give: all of them before `auto` has chosen.
std::vector<Parameter> parameters_of_run(const Method& m) {
  return formulation_registry().look_up(m.formulation) ? parameters_of(m.formulation, m.operators)
                                                       : method_parameters();
}

}  // namespace

void check_method_keys(const TableReader& reader, const Method& m) {
  const std::vector<Parameter> own = parameters_of_run(m);
  for (const Parameter& p : method_parameters())
    if (reader.has(p.name) && !find_parameter(own, p.name))
      reader.fail_at(p.name,
                     fmt::format("{}{} has no such key; it has: {}", m.formulation,
                                 has_operators(m.formulation) ? " with " + m.operators + " operators" : "",
                                 own.empty() ? "none" : join_names(parameter_names(own))));
  if (formulation_registry().look_up(m.formulation))
    for (const Parameter& p : own)
      if (p.required) reader.require(p.name);
}

namespace {

Method read_method(const TableReader& reader) {
  // A scene that names a formulation means the plain operators; `auto` fills in what it leaves open.
  Method m = with_defaults({});
  std::vector<std::string> formulations = names().formulations;
  formulations.insert(formulations.begin(), "auto");
  m.formulation = reader.choice("formulation", formulations);
  m.operators = reader.choice("operators", names().operators, m.operators);
  m.support_dx = default_support(m.formulation, m.operators);
  check_method_keys(reader, m);
  for (const Parameter& p : parameters_of_run(m))
    if (reader.has(p.name)) set_parameter(m, p.name, reader.value(p));
  return m;
}

}  // namespace

RunSpec read_run(const Node& node, const LatticeSpec* lattice, const SolveSpec& solve) {
  const TableReader reader(node, "run", keys_of("run"));
  RunSpec run;
  run.place = node.place;
  run.label = reader.text("label");
  run.method = read_method(reader);
  if (reader.has("only")) {
    const TableReader only(reader.require("only"), "run.only", keys_of("run.only"));
    for (const std::string& key : keys_of("run.only"))
      if (only.has(key)) run.only[key] = only.numbers(key, Range::any());
  }

  if (lattice) run.lattice = *lattice;
  for (const char* key : {"lattice", "dx", "jitter", "seed"}) {
    if (!reader.has(key)) continue;
    if (!lattice) reader.fail_at(key, "a cloud from a CSV file has no lattice");
    run.lattice.place = reader.require(key).place;
  }
  if (reader.has("lattice"))
    run.lattice.kind = reader.choice("lattice", {"node_centred", "cell_centred"}) == "node_centred"
                           ? Lattice::node_centred
                           : Lattice::cell_centred;
  run.lattice.dx = reader.number("dx", Range::positive(), run.lattice.dx);
  run.lattice.jitter = reader.number("jitter", Range{0, 0.4, false, false}, run.lattice.jitter);
  run.lattice.seed = static_cast<unsigned>(reader.integer("seed", 0, 4294967295LL, run.lattice.seed));

  if (reader.has("material")) run.material = reader.choice("material", names().materials);
  if (reader.has("plane"))
    run.plane = reader.choice("plane", {"strain", "stress"}) == "stress" ? Plane::stress : Plane::strain;
  run.solve = reader.has("solve") ? read_solve(reader.require("solve"), &solve) : solve;
  return run;
}

}  // namespace taut::bench
