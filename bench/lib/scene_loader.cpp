#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/auto_rules.hpp>
#include <lib/scene_keys.hpp>
#include <lib/scene_loader.hpp>
#include <lib/scene_parts.hpp>
#include <set>

namespace taut::bench {
namespace {

/// Some hours of the smallest cases; a report of more cannot be read.
constexpr int most_cases = 10'000;

Range sweep_range(const std::string& key) {
  if (key == "nu") return {-1, 0.5, true, true};
  if (key == "load") return Range::any();
  return Range::positive();
}

void read_head(const Node& node, Scene& scene) {
  const TableReader reader(node, "scene", keys_of("scene"));
  scene.place = node.place;
  scene.name = reader.text("name");
  for (const char c : scene.name)
    if (!(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9') && c != '_')
      reader.fail_at("name", fmt::format("'{}' is not snake_case (a–z, 0–9, _)", brief(scene.name)));
  scene.title = reader.text("title", scene.name);
  scene.description = reader.prose("description", "-");
  if (scene.description == "-") scene.description.clear();
  scene.accuracy = reader.number("accuracy", Range{0, 1, true, false}, scene.accuracy);
  scene.dimension = static_cast<int>(reader.integer("dimension", 1, 3));
}

void read_sweep(const TableReader& top, Scene& scene) {
  if (!top.has("sweep")) return;
  const TableReader reader(top.require("sweep"), "sweep", keys_of("sweep"));
  for (const std::string& key : keys_of("sweep"))
    if (reader.has(key)) {
      scene.sweep.emplace_back(key, reader.numbers(key, sweep_range(key)));
      reader.check_distinct(key, scene.sweep.back().second);
    }
  // Asked before the cases are listed: four lists of a few thousand are more than any memory.
  double cases = static_cast<double>(scene.runs.size());
  for (const auto& [key, values] : scene.sweep) cases *= static_cast<double>(values.size());
  if (cases > most_cases)
    fail(reader.place(),
         fmt::format("[sweep] makes {:g} cases of {} runs, but {} is the most that a scene may have", cases,
                     scene.runs.size(), most_cases));
  const auto swept = [&](const std::string& key) { return reader.has(key); };
  const auto loads = std::count_if(scene.boundaries.begin(), scene.boundaries.end(),
                                   [](const BoundarySpec& b) { return b.type == "load"; });
  if (swept("load") && loads != 1)
    reader.fail_at(
        "load",
        fmt::format("sweeps the force of the one [[boundary]] of type load, but the scene has {}", loads));
  if (swept("region_density") && scene.regions.empty())
    reader.fail_at("region_density", "the scene has no [[region]]");
  if (swept("dx") && !top.has("lattice")) reader.fail_at("dx", "the scene has no [lattice]");
  if (swept("dx"))
    for (const Node& node : top.tables("run"))
      if (const Node* own = TableReader(node, "run", keys_of("run")).find("dx"))
        fail(own->place, "[run] dx: a run cannot have its own while [sweep] dx sets it");
}

void check_labels(const Place& place, const std::string& what, const std::vector<std::string>& wanted,
                  const Scene& scene) {
  std::vector<std::string> labels;
  for (const RunSpec& run : scene.runs) labels.push_back(run.label);
  for (const std::string& label : wanted)
    if (std::find(labels.begin(), labels.end(), label) == labels.end())
      fail(place, fmt::format("{}: no run is labelled '{}'; valid: {}", what, brief(label), join(labels)));
}

void apply_quick(const Node& node, Scene& scene, bool quick) {
  const TableReader reader(node, "quick", keys_of("quick"));
  Scene changed = scene;
  for (const std::string& key : keys_of("sweep")) {
    if (!reader.has(key)) continue;
    const std::vector<double> values = reader.numbers(key, sweep_range(key));
    reader.check_distinct(key, values);
    const auto swept = std::find_if(changed.sweep.begin(), changed.sweep.end(),
                                    [&](const auto& s) { return s.first == key; });
    if (swept != changed.sweep.end()) {
      swept->second = values;
    } else if (key == "dx" && values.size() == 1) {
      changed.lattice.dx = values[0];
      for (RunSpec& run : changed.runs) run.lattice.dx = values[0];
    } else {
      reader.fail_at(key, "is not swept by [sweep]" + std::string(key == "dx" ? "; give one number" : ""));
    }
  }
  if (reader.has("runs")) {
    const std::vector<std::string> labels = reader.texts("runs");
    check_labels(reader.require("runs").place, "[quick] runs", labels, scene);
    std::erase_if(changed.runs, [&](const RunSpec& run) {
      return std::find(labels.begin(), labels.end(), run.label) == labels.end();
    });
  }
  const auto shorten = [&](SolveSpec& solve) {
    if (reader.has("duration")) solve.duration = reader.number("duration", Range::positive());
    if (reader.has("tolerance")) solve.tolerance = reader.number("tolerance", Range{0, 1, true, true});
  };
  shorten(changed.solve);
  for (RunSpec& run : changed.runs) shorten(run.solve);
  if (quick) scene = std::move(changed);  // read even when not asked for, so that its mistakes show
}

/// After the sweep is known, and before anything asks for a run's formulation.
void choose_methods(const TableReader& top, Scene& scene) {
  const NodeArray& nodes = top.tables("run");
  for (std::size_t i = 0; i < scene.runs.size(); ++i) {
    RunSpec& run = scene.runs[i];
    if (run.method.formulation != "auto") continue;
    const TableReader reader(nodes[i], "run", keys_of("run"));
    std::set<std::string> given;
    for (const std::string& key : keys_of("run"))
      if (key != "formulation" && reader.has(key)) given.insert(key);
    run.automatic = apply_auto_rules(facts_of(scene, run, given), given, run.method);
    check_method_keys(reader, run.method);
  }
}

void check_probes(const Scene& scene) {
  for (const ProbeSpec& probe : scene.probes) {
    const auto named = [&](const std::string& name) {
      return std::count_if(scene.probes.begin(), scene.probes.end(),
                           [&](const ProbeSpec& p) { return p.name == name; });
    };
    if (named(probe.name) > 1) fail(probe.place, fmt::format("[probe] name: '{}' is used twice", probe.name));
    if (!probe.over.empty() && (named(probe.over) != 1 || probe.over == probe.name))
      fail(probe.place, fmt::format("[probe] over: no other probe is named '{}'", probe.over));
    check_labels(probe.place, "[probe] only", probe.only.runs, scene);
    for (const PrintedSpec& printed : probe.printed)
      check_labels(probe.place, "[probe] printed", printed.runs, scene);
    if (probe.measure != "final")
      for (const RunSpec& run : scene.runs)
        if (run.solve.mode != "dynamic")
          fail(probe.place,
               fmt::format(
                   "[probe] measure: '{}' needs a history in time, but the run '{}' is relaxed to rest",
                   probe.measure, run.label));
    for (const RunSpec& run : scene.runs)
      if (run.solve.mode == "dynamic" && probe.window[0] > run.solve.duration)
        for (const SweepPoint& point : scene.points())
          if (wanted(run, point) && wanted(probe, run, point))
            fail(probe.place,
                 fmt::format("[probe] window: '{}' begins at {:g} s, after the end of the run '{}' at {:g} s",
                             probe.name, probe.window[0], run.label, run.solve.duration));
  }
}

Scene build_scene(const Node& root, const std::string& name, const std::filesystem::path& folder,
                  bool quick) {
  const TableReader top(root, "top level", keys_of("top level"));
  Scene scene;
  scene.file = name;
  read_head(top.require("scene"), scene);
  const SceneContext context{static_cast<std::size_t>(scene.dimension), folder};
  scene.geometry = read_shape(top.require("geometry"), context);
  const bool cloud = scene.geometry.type == "csv";
  if (cloud && top.has("lattice")) top.fail_at("lattice", "a cloud from a CSV file has no lattice");
  if (!cloud) scene.lattice = read_lattice(top.require("lattice"));
  scene.material = read_material(top.require("material"));
  if (top.has("region"))
    for (const Node& node : top.tables("region"))
      scene.regions.push_back(read_region(node, scene.material, context));
  if (top.has("boundary"))
    for (const Node& node : top.tables("boundary")) scene.boundaries.push_back(read_boundary(node, context));
  if (top.has("initial"))
    for (const Node& node : top.tables("initial")) scene.initial.push_back(read_initial(node, context));
  scene.solve = read_solve(top.require("solve"), nullptr);
  for (const Node& node : top.tables("probe")) scene.probes.push_back(read_probe(node, context));
  for (const Node& node : top.tables("run")) {
    scene.runs.push_back(read_run(node, cloud ? nullptr : &scene.lattice, scene.solve));
    for (std::size_t i = 0; i + 1 < scene.runs.size(); ++i)
      if (scene.runs[i].label == scene.runs.back().label)
        fail(node.place, fmt::format("[run] label: '{}' is used twice", scene.runs[i].label));
  }
  read_sweep(top, scene);
  choose_methods(top, scene);
  for (std::size_t i = 0; i < scene.boundaries.size(); ++i) {
    const BoundarySpec& boundary = scene.boundaries[i];
    const bool swept =
        std::any_of(scene.sweep.begin(), scene.sweep.end(), [](const auto& s) { return s.first == "load"; });
    if (boundary.type == "load" && !swept && boundary.force == 0)
      fail(boundary.place, "[boundary] load: give force [N], or list forces in [sweep] load");
  }
  check_probes(scene);
  if (top.has("picture"))
    for (const Node& node : top.tables("picture")) {
      scene.pictures.push_back(read_picture(node, context));
      check_labels(node.place, "[picture] runs", scene.pictures.back().runs, scene);
    }
  if (top.has("quick")) apply_quick(top.require("quick"), scene, quick);
  return scene;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file, bool quick) {
  return build_scene(parse_toml(file), file.string(), file.parent_path(), quick);
}

Scene parse_scene(const std::string& text, const std::string& name, bool quick) {
  return build_scene(parse_toml(text, name), name, {}, quick);
}

}  // namespace taut::bench
