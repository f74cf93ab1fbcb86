#include <fmt/format.h>

#include <lib/names.hpp>
#include <lib/scene_keys.hpp>
#include <lib/scene_parts.hpp>

namespace taut::bench {
namespace {

Method read_method(const TableReader& reader) {
  // A scene that names a formulation means the plain operators; `auto` fills in what it leaves open.
  Method m = with_defaults({});
  std::vector<std::string> formulations = names().formulations;
  formulations.insert(formulations.begin(), "auto");
  m.formulation = reader.choice("formulation", formulations);
  m.operators = reader.choice("operators", names().operators, m.operators);
  m.kernel = reader.choice("kernel", names().kernels, m.kernel);
  // Below one spacing no lattice particle has a neighbour; beyond ten a list no longer fits any memory.
  m.support_dx =
      reader.number("support_dx", Range{1, 10, true, false}, default_support(m.formulation, m.operators));
  m.neighbours = reader.choice("neighbours", names().neighbours, m.neighbours);
  m.pair_precision = pair_precision(reader.choice("pair_precision", pair_precision_names(), "automatic"));
  if (reader.has("zero_energy_control"))
    m.zero_energy_control = reader.number("zero_energy_control", Range::non_negative());
  m.viscosity = reader.number("viscosity", Range::non_negative(), m.viscosity);
  m.skin = reader.number("skin", Range{0, 2, false, false}, m.skin);
  m.velocity_gradient = reader.choice("velocity_gradient", {"standard", "corrected"}, m.velocity_gradient);
  m.artificial_stress = reader.number("artificial_stress", Range::non_negative(), m.artificial_stress);
  m.artificial_stress_exponent =
      reader.number("artificial_stress_exponent", Range::positive(), m.artificial_stress_exponent);
  m.artificial_stress_weight =
      reader.choice("artificial_stress_weight", {"kernel", "distance"}, m.artificial_stress_weight);
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
