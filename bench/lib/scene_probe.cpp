#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/analytic.hpp>
#include <lib/scene_keys.hpp>
#include <lib/scene_parts.hpp>

namespace taut::bench {
namespace {

OnlySpec read_only(const Node& node) {
  const TableReader reader(node, "only", keys_of("only"));
  OnlySpec only;
  if (reader.has("run")) only.runs = reader.texts("run");
  if (reader.has("formulation")) only.formulations = reader.texts("formulation");
  for (const std::string& key : keys_of("sweep"))
    if (reader.has(key)) only.values[key] = reader.numbers(key, Range::any());
  return only;
}

ReferenceSpec read_reference(const Node& node, const SceneContext& context) {
  ReferenceSpec reference;
  reference.place = node.place;
  if (const auto* integer = node.as<std::int64_t>()) {
    reference.number = static_cast<double>(*integer);
    return reference;
  }
  if (const auto* number = node.as<double>()) {
    if (!Range::any().contains(*number)) fail(node.place, "[probe] reference: must be finite");
    reference.number = *number;
    return reference;
  }
  if (!node.as<NodeTable>())
    fail(node.place,
         fmt::format("[probe] reference: must be a number or a table with file or analytic, but is {}",
                     node.kind()));
  std::vector<std::string> all = keys_of("reference", "file");
  for (const std::string& key : keys_of("reference", "analytic")) all.push_back(key);
  const bool exact = TableReader(node, "reference", all).has("analytic");
  const TableReader reader(node, "reference", keys_of("reference", exact ? "analytic" : "file"));
  reference.label = reader.text("label", exact ? "exact" : "reference");
  if (exact) {
    reference.analytic = reader.choice("analytic", analytic_names());
    return reference;
  }
  reference.file = context.resolve(reader.text("file"));
  reference.column = reader.text("column");
  reference.scale = reader.number("scale", Range::any(), 1);
  const TableReader keys(reader.require("keys"), "reference.keys", keys_of("sweep"));
  for (const std::string& key : keys_of("sweep"))
    if (keys.has(key)) reference.keys[key] = keys.text(key);
  if (reference.keys.empty())
    reader.fail_at("keys", "must name at least one column, as { load = \"load_N\" }");
  return reference;
}

PrintedSpec read_printed(const Node& node, double scale) {
  const TableReader reader(node, "printed", keys_of("printed"));
  PrintedSpec printed{
      reader.text("label"), reader.text("column"), {}, reader.number("scale", Range::any(), scale)};
  if (reader.has("runs")) printed.runs = reader.texts("runs");
  return printed;
}

void read_component(const TableReader& reader, ProbeSpec& probe, const SceneContext& context) {
  if (probe.type == "cauchy_stress") {
    const std::string axes = "xyz";
    std::vector<std::string> valid;
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = r; c < 3; ++c)
        if (c == r || c < context.dimension) valid.push_back({axes[r], axes[c]});
    const std::string name = reader.choice("component", valid);
    probe.row = axis_number(name);
    probe.column = axis_number(name.substr(1));
  }
  const std::vector<std::string> keys = keys_of("probe", probe.type);
  const auto takes = [&](const char* key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
  if (takes("axis")) probe.row = axis_number(reader.choice("axis", context.axes()));
  if (takes("at")) {
    probe.at = reader.vector("at", context.dimension);
    probe.at_place = reader.require("at").place;
  }
}

}  // namespace

ProbeSpec read_probe(const Node& node, const SceneContext& context) {
  std::vector<std::string> all = keys_of("probe");
  for (const std::string& variant : variants_of("probe"))
    for (const std::string& key : keys_of("probe", variant)) all.push_back(key);
  all.insert(all.end(), {"window", "over"});
  const TableReader any(node, "probe", all);

  ProbeSpec probe;
  probe.place = node.place;
  probe.type = any.choice("type", variants_of("probe"));
  probe.measure = any.choice("measure", variants_of("measure"), "final");
  std::vector<std::string> keys = keys_of("probe", probe.type);
  for (const std::string& key : keys_of("measure", probe.measure)) keys.push_back(key);
  const TableReader reader(node, "probe", keys);

  probe.name = reader.text("name");
  for (const char c : probe.name)
    if (!(c >= 'a' && c <= 'z') && !(c >= '0' && c <= '9') && c != '_')
      reader.fail_at("name", fmt::format("'{}' is not snake_case (a–z, 0–9, _)", brief(probe.name)));
  read_component(reader, probe, context);
  if (reader.has("window")) {
    const std::vector<double> window = reader.vector("window", 2);
    if (window[1] <= window[0]) reader.fail_at("window", "the interval [from, to] needs from < to");
    probe.window = {window[0], window[1]};
  }
  probe.over = reader.text("over", "");
  if (reader.has("only")) probe.only = read_only(reader.require("only"));
  if (reader.has("reference")) probe.reference = read_reference(reader.require("reference"), context);
  if (reader.has("printed")) {
    if (!probe.reference || probe.reference->file.empty())
      reader.fail_at("printed", "needs a reference with a file, whose columns it names");
    for (const Node& entry : reader.tables("printed"))
      probe.printed.push_back(read_printed(entry, probe.reference->scale));
  }
  if (probe.measure == "curve_error" && (!probe.reference || probe.reference->analytic.empty()))
    reader.fail_at("measure",
                   "curve_error needs reference = { analytic = … }; valid: " + join(analytic_names()));
  return probe;
}

namespace {

/// A name, or the direction in which the viewer stands.
std::array<double, 3> read_view(const TableReader& reader, const SceneContext& context) {
  if (context.dimension != 3) {
    if (reader.has("view")) reader.fail_at("view", "needs dimension = 3");
    return {0, 0, 1};
  }
  const Node* node = reader.find("view");
  if (node && node->as<NodeArray>()) {
    std::vector<double> from = reader.vector("view", 3);
    const double length = std::hypot(from[0], from[1], from[2]);
    if (!(length > 0) || !std::isfinite(length))
      reader.fail_at("view", "the direction in which the viewer stands must have a length");
    return {from[0] / length, from[1] / length, from[2] / length};
  }
  std::vector<std::string> names;
  for (const auto& [name, from] : picture_views()) names.push_back(name);
  const std::string wanted = reader.choice("view", names, "corner");
  for (const auto& [name, from] : picture_views())
    if (name == wanted) return from;
  return {0, 0, 1};
}

}  // namespace

PictureSpec read_picture(const Node& node, const SceneContext& context) {
  const TableReader reader(node, "picture", keys_of("picture"));
  PictureSpec picture;
  picture.place = node.place;
  picture.title = reader.text("title");
  picture.field = reader.choice("field", picture_fields(), "von_mises");
  picture.from = read_view(reader, context);
  if (reader.has("of")) {
    const TableReader of(reader.require("of"), "picture.of", keys_of("sweep"));
    for (const std::string& key : keys_of("sweep"))
      if (of.has(key)) picture.of[key] = of.number(key, Range::any());
  }
  if (reader.has("runs")) picture.runs = reader.texts("runs");
  return picture;
}

}  // namespace taut::bench
