#include <fmt/format.h>

#include <lib/names.hpp>
#include <lib/scene_keys.hpp>
#include <lib/scene_parts.hpp>
#include <taut/materials/registry.hpp>

namespace taut::bench {

std::vector<std::string> SceneContext::axes() const {
  const std::vector<std::string> all = {"x", "y", "z"};
  return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(dimension)};
}

std::vector<std::string> SceneContext::faces() const {
  std::vector<std::string> faces;
  for (const std::string& axis : axes())
    for (const char* side : {"_min", "_max"}) faces.push_back(axis + side);
  return faces;
}

int axis_number(const std::string& name) { return name[0] - 'x'; }

TableReader variant_reader(const Node& node, const std::string& table, const std::string& key) {
  std::vector<std::string> all = keys_of(table);
  for (const std::string& variant : variants_of(table))
    for (const std::string& name : keys_of(table, variant)) all.push_back(name);
  const std::string variant = TableReader(node, table, all).choice(key, variants_of(table));
  return TableReader(node, table, keys_of(table, variant));
}

/// Each is asked for each place of the lattice.
constexpr std::size_t most_shapes = 2000;

ShapeSpec read_shape(const Node& node, const SceneContext& context) {
  const TableReader reader = variant_reader(node, "geometry", "type");
  const std::size_t d = context.dimension;
  ShapeSpec shape;
  shape.place = node.place;
  shape.type = reader.text("type");
  if (shape.type == "box") {
    shape.min = reader.vector("min", d);
    shape.max = reader.vector("max", d);
    for (std::size_t i = 0; i < d; ++i)
      if (shape.max[i] <= shape.min[i])
        reader.fail_at("max", fmt::format("{:g} along {} is not above min = {:g}: the body is empty",
                                          shape.max[i], context.axes()[i], shape.min[i]));
  } else if (shape.type == "sphere") {
    shape.centre = reader.vector("centre", d);
    shape.radius = reader.number("radius", Range::positive());
  } else if (shape.type == "ring") {
    shape.centre = reader.vector("centre", d);
    shape.inner_radius = reader.number("inner_radius", Range::positive());
    shape.outer_radius = reader.number("outer_radius", Range::positive());
    if (shape.outer_radius <= shape.inner_radius)
      reader.fail_at("outer_radius", fmt::format("{:g} is not above inner_radius = {:g}: the body is empty",
                                                 shape.outer_radius, shape.inner_radius));
  } else if (shape.type == "cylinder") {
    if (d != 3)
      reader.fail_at("type", "a cylinder needs dimension = 3; in 2D its section is a sphere or a box");
    shape.from = reader.vector("from", d);
    shape.to = reader.vector("to", d);
    if (shape.from == shape.to) reader.fail_at("to", "is the same point as from: the body is empty");
    shape.radius = reader.number("radius", Range::positive());
  } else if (shape.type == "csv") {
    shape.file = context.resolve(reader.text("file"));
  } else {
    const NodeArray& parts = reader.tables("of");
    if (parts.size() > most_shapes)
      reader.fail_at("of", fmt::format("lists {} shapes, but {} is the most", parts.size(), most_shapes));
    if (parts.size() < 2) reader.fail_at("of", fmt::format("a {} needs at least two shapes", shape.type));
    for (const Node& part : parts) {
      shape.of.push_back(read_shape(part, context));
      if (shape.of.back().type == "csv")
        fail(part.place, "[geometry] of: a csv cloud cannot be part of a " + shape.type);
    }
  }
  return shape;
}

LatticeSpec read_lattice(const Node& node) {
  const TableReader reader(node, "lattice", keys_of("lattice"));
  LatticeSpec lattice;
  lattice.place = node.place;
  const std::string kind = reader.choice("kind", {"node_centred", "cell_centred"}, "node_centred");
  lattice.kind = kind == "node_centred" ? Lattice::node_centred : Lattice::cell_centred;
  lattice.dx = reader.number("dx", Range::positive());
  lattice.jitter = reader.number("jitter", Range{0, 0.4, false, false}, 0);
  lattice.seed = static_cast<unsigned>(reader.integer("seed", 0, 4294967295LL, 1));
  return lattice;
}

namespace {

void read_material_keys(const TableReader& reader, MaterialSpec& material, bool all) {
  MaterialParameters& p = material.parameters;
  if (all || reader.has("model")) material.model = reader.choice("model", names().materials);
  const MaterialEntry& entry = material_registry().find(material.model);
  const std::vector<Parameter> own = parameters_of(entry);
  for (const Parameter& other : material_parameters())
    if (reader.has(other.name) && !find_parameter(own, other.name))
      reader.fail_at(other.name, fmt::format("{} has no such key; it has: {}", material.model,
                                             join_names(parameter_names(own))));
  if (all || reader.has("E")) p.E = reader.number("E", Range::positive());
  if (all || reader.has("nu")) p.nu = reader.number("nu", Range{-1, 0.5, true, true});
  if (all || reader.has("density")) p.density = reader.number("density", Range::positive());
  if (reader.has("plane"))
    p.plane = reader.choice("plane", find_parameter(own, "plane")->choices()) == "stress" ? Plane::stress
                                                                                          : Plane::strain;
  keep_own(material);
  for (const Parameter& extra : entry.parameters)
    if (reader.has(extra.name) || (extra.required && !p.other.contains(extra.name)))
      p.other.insert_or_assign(extra.name, reader.value(extra));
}

}  // namespace

MaterialSpec read_material(const Node& node) {
  const TableReader reader(node, "material", keys_of("material"));
  MaterialSpec material;
  material.place = node.place;
  read_material_keys(reader, material, true);
  return material;
}

Selection read_selection(const TableReader& reader, const SceneContext& context, bool required) {
  Selection selection;
  if (reader.has("on")) selection.on = reader.choice("on", context.faces());
  if (reader.has("where")) {
    const TableReader where(reader.require("where"), reader.table() + ".where", context.axes());
    for (const std::string& axis : context.axes())
      if (where.has(axis)) {
        const std::vector<double> interval = where.vector(axis, 2);
        if (interval[1] < interval[0]) where.fail_at(axis, "the interval [a, b] needs a ≤ b");
        selection.where[axis_number(axis)] = {interval[0], interval[1]};
      }
    if (selection.where.empty())
      reader.fail_at("where",
                     "is empty; give intervals such as { x = [0, 0.1] } along " + join(context.axes()));
  }
  if (required && selection.empty())
    fail(reader.place(), fmt::format("[{}] selects nothing: give on = one of {}, or where = {{ x = [a, b] }}",
                                     reader.table(), join(context.faces())));
  return selection;
}

RegionSpec read_region(const Node& node, const MaterialSpec& base, const SceneContext& context) {
  const TableReader reader(node, "region", keys_of("region"));
  RegionSpec region{read_selection(reader, context, true), base, node.place};
  region.material.place = node.place;
  read_material_keys(reader, region.material, false);
  return region;
}

SolveSpec read_solve(const Node& node, const SolveSpec* base) {
  std::vector<std::string> all = keys_of("solve", "relax");
  for (const std::string& key : keys_of("solve", "dynamic")) all.push_back(key);
  const TableReader any(node, "solve", all);
  SolveSpec solve = base ? *base : SolveSpec{};
  solve.place = node.place;
  solve.mode =
      base ? any.choice("mode", variants_of("solve"), base->mode) : any.choice("mode", variants_of("solve"));
  const TableReader reader(node, "solve", keys_of("solve", solve.mode));
  solve.cfl = reader.number("cfl", Range{0, 1, true, false}, solve.cfl);
  if (solve.mode == "relax") {
    solve.tolerance = reader.number("tolerance", Range{0, 1, true, true}, solve.tolerance);
    solve.ramp_time = reader.number("ramp_time", Range::non_negative(), solve.ramp_time);
    solve.free_time = reader.number("free_time", Range::non_negative(), solve.free_time);
    solve.max_steps = reader.integer("max_steps", 1, 1'000'000'000'000LL, solve.max_steps);
  } else {
    if (!base || base->mode != "dynamic" || reader.has("duration"))
      solve.duration = reader.number("duration", Range::positive());
    solve.integrator = reader.choice("integrator", names().integrators, solve.integrator);
    solve.max_step = reader.number("max_step", Range::positive(), solve.max_step);
    solve.samples = static_cast<int>(reader.integer("samples", 10, 1'000'000, solve.samples));
  }
  return solve;
}

}  // namespace taut::bench
