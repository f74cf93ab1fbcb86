#include <lib/names.hpp>
#include <lib/scene_keys.hpp>

namespace taut::bench {

namespace {

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<Parameter>& parameters,
                                const std::vector<std::string>& last = {}) {
  for (const Parameter& p : parameters) first.push_back(p.name);
  first.insert(first.end(), last.begin(), last.end());
  return first;
}

}  // namespace

std::vector<SceneTable> scene_tables() {
  return {
      {"top level",
       "",
       {"scene", "geometry", "lattice", "material", "region", "boundary", "initial", "solve", "probe",
        "sweep", "run", "picture", "quick"}},
      {"scene", "", {"name", "title", "dimension", "description", "accuracy"}},
      {"geometry", "", {"type"}},
      {"geometry", "box", {"min", "max"}},
      {"geometry", "sphere", {"centre", "radius"}},
      {"geometry", "ring", {"centre", "inner_radius", "outer_radius"}},
      {"geometry", "cylinder", {"from", "to", "radius"}},
      {"geometry", "union", {"of"}},
      {"geometry", "difference", {"of"}},
      {"geometry", "csv", {"file"}},
      {"lattice", "", {"kind", "dx", "jitter", "seed"}},
      {"material", "", joined({"model"}, material_parameters())},
      {"region", "", joined({"on", "where", "model"}, material_parameters())},
      {"boundary", "", {"type"}},
      {"boundary", "clamp", {"on", "where", "layers"}},
      {"boundary", "roller", {"on", "where", "axis"}},
      {"boundary", "prescribed", {"on", "where", "axis", "displacement", "history"}},
      {"boundary", "load", {"on", "where", "force", "direction", "history"}},
      {"boundary", "body_force", {"acceleration", "history"}},
      {"boundary", "symmetry", {"on"}},
      {"boundary", "periodic", {"axis"}},
      {"history", "", {"type"}},
      {"history", "constant", {"start"}},
      {"history", "linear", {"start", "duration"}},
      {"history", "smoothstep", {"start", "duration"}},
      {"history", "raised_cosine", {"start", "duration"}},
      {"history", "square", {"start", "duration"}},
      {"history", "table", {"values"}},
      {"initial", "", {"on", "where", "velocity", "stretch"}},
      {"solve", "", {"mode", "cfl"}},
      {"solve", "relax", {"tolerance", "ramp_time", "free_time", "max_steps"}},
      {"solve", "dynamic", {"duration", "integrator", "max_step", "samples"}},
      {"probe", "", {"name", "type", "measure", "only", "reference", "printed"}},
      {"probe", "displacement", {"at", "axis"}},
      {"probe", "velocity", {"at", "axis"}},
      {"probe", "cauchy_stress", {"at", "component"}},
      {"probe", "von_mises", {"at"}},
      {"probe", "pressure", {"at"}},
      {"probe", "linear_momentum", {"axis"}},
      {"probe", "kinetic_energy", {}},
      {"probe", "strain_energy", {}},
      {"measure", "final", {}},
      {"measure", "peak", {"window", "over"}},
      {"measure", "arrival_time", {"window"}},
      {"measure", "curve_error", {"window"}},
      {"only", "", {"run", "formulation", "load", "nu", "dx", "region_density"}},
      {"run.only", "", {"load", "nu", "dx", "region_density"}},
      {"reference", "", {"label"}},
      {"reference", "file", {"file", "column", "keys", "scale"}},
      {"reference", "analytic", {"analytic"}},
      {"printed", "", {"label", "column", "runs", "scale"}},
      {"sweep", "", {"load", "nu", "dx", "region_density"}},
      {"run", "",
       joined({"label", "only", "formulation"}, method_parameters(),
              {"lattice", "dx", "jitter", "seed", "material", "plane", "solve"})},
      {"picture", "", {"title", "field", "view", "of", "runs"}},
      {"quick", "", {"load", "nu", "dx", "region_density", "runs", "duration", "tolerance"}},
  };
}

std::vector<std::string> keys_of(std::string_view table, std::string_view variant) {
  std::vector<std::string> keys;
  for (const SceneTable& entry : scene_tables())
    if (entry.table == table && (entry.variant.empty() || entry.variant == variant))
      keys.insert(keys.end(), entry.keys.begin(), entry.keys.end());
  return keys;
}

std::vector<std::string> picture_fields() {
  return {"von_mises", "cauchy_xx", "cauchy_yy", "cauchy_zz", "cauchy_xy"};
}

const std::vector<std::pair<std::string, std::array<double, 3>>>& picture_views() {
  static const std::vector<std::pair<std::string, std::array<double, 3>>> views = {
      {"corner", {1, -2, 1}}, {"along_x", {1, 0, 0}}, {"along_y", {0, -1, 0}}, {"along_z", {0, 0, 1}}};
  return views;
}

std::vector<std::string> variants_of(std::string_view table) {
  std::vector<std::string> variants;
  for (const SceneTable& entry : scene_tables())
    if (entry.table == table && !entry.variant.empty()) variants.push_back(entry.variant);
  return variants;
}

}  // namespace taut::bench
