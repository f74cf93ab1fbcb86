#include <algorithm>
#include <lib/scene_keys.hpp>
#include <lib/scene_parts.hpp>

namespace taut::bench {
namespace {

std::vector<std::array<double, 2>> read_table(const TableReader& reader) {
  std::vector<std::array<double, 2>> values;
  const Node& node = reader.require("values");
  const auto* rows = node.as<NodeArray>();
  if (!rows || rows->empty()) reader.fail_at("values", "must be an array of [time, factor] pairs");
  for (const Node& row : *rows) {
    const auto* pair = row.as<NodeArray>();
    const auto number = [&](const Node& entry) {
      if (const auto* integer = entry.as<std::int64_t>()) return static_cast<double>(*integer);
      if (const auto* value = entry.as<double>(); value && Range::any().contains(*value)) return *value;
      fail(entry.place, "[history] values: must be a finite number");
    };
    if (!pair || pair->size() != 2) fail(row.place, "[history] values: each entry must be [time, factor]");
    values.push_back({number((*pair)[0]), number((*pair)[1])});
    if (values.size() > 1 && values.back()[0] <= values[values.size() - 2][0])
      fail(row.place, "[history] values: times must increase");
  }
  return values;
}

}  // namespace

HistorySpec read_history(const Node& node) {
  const TableReader reader = variant_reader(node, "history", "type");
  HistorySpec history;
  history.type = reader.text("type");
  if (history.type == "table") {
    history.values = read_table(reader);
    return history;
  }
  history.start = reader.number("start", Range::non_negative(), 0);
  if (history.type != "constant") history.duration = reader.number("duration", Range::positive());
  return history;
}

BoundarySpec read_boundary(const Node& node, const SceneContext& context) {
  const TableReader reader = variant_reader(node, "boundary", "type");
  BoundarySpec boundary;
  boundary.place = node.place;
  boundary.type = reader.text("type");
  if (boundary.type == "symmetry") {
    boundary.selection.on = reader.choice("on", context.faces());
    return boundary;
  }
  if (boundary.type == "periodic") {
    boundary.axis = axis_number(reader.choice("axis", context.axes()));
    return boundary;
  }
  if (reader.has("history")) boundary.history = read_history(reader.require("history"));
  if (boundary.type == "body_force") {
    boundary.acceleration = reader.vector("acceleration", context.dimension);
    return boundary;
  }
  boundary.selection = read_selection(reader, context, true);
  const std::string face_axis = boundary.selection.on.substr(0, 1);
  if (boundary.type == "clamp") {
    boundary.layers = static_cast<int>(reader.integer("layers", 0, 20, 0));
    if (boundary.layers > 0 && boundary.selection.on.empty())
      reader.fail_at("layers", "needs a face: on = \"x_min\", …");
  } else if (boundary.type == "roller" || boundary.type == "prescribed") {
    boundary.axis = axis_number(face_axis.empty() ? reader.choice("axis", context.axes())
                                                  : reader.choice("axis", context.axes(), face_axis));
    if (boundary.type == "prescribed") boundary.displacement = reader.number("displacement", Range::any());
  } else {
    boundary.force = reader.number("force", Range::any(), 0);
    boundary.direction = reader.vector("direction", context.dimension);
    if (std::all_of(boundary.direction.begin(), boundary.direction.end(), [](double c) { return c == 0; }))
      reader.fail_at("direction", "must not be zero");
  }
  return boundary;
}

InitialSpec read_initial(const Node& node, const SceneContext& context) {
  const TableReader reader(node, "initial", keys_of("initial"));
  InitialSpec initial{read_selection(reader, context, false), {}, {}, node.place};
  if (reader.has("velocity")) initial.velocity = reader.vector("velocity", context.dimension);
  if (reader.has("stretch")) initial.stretch = reader.vector("stretch", context.dimension);
  if (initial.velocity.empty() && initial.stretch.empty())
    fail(node.place, "[initial] gives nothing: set velocity or stretch");
  for (const double s : initial.stretch)
    if (s <= 0) reader.fail_at("stretch", "must be positive along every axis");
  return initial;
}

}  // namespace taut::bench
