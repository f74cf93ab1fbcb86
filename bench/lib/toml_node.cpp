#include <toml++/toml.h>

#include <fstream>
#include <lib/toml_node.hpp>
#include <sstream>

namespace taut::bench {
namespace {

using File = std::shared_ptr<const std::string>;

Place place_of(const toml::source_region& source, const File& file) {
  return {file, source.begin.line, source.begin.column};
}

Node convert(const toml::node& node, const File& file) {
  Node out{place_of(node.source(), file), {}, OtherNode{}};
  if (const auto* table = node.as_table()) {
    NodeTable values;
    for (const auto& [key, value] : *table) {
      Node child = convert(value, file);
      // A message about a key should point at the key, not at the far end of its value.
      if (key.source().begin.line) child.place = place_of(key.source(), file);
      child.key = std::string(key.str());
      values.entries.push_back(std::move(child));
    }
    out.value = std::move(values);
  } else if (const auto* array = node.as_array()) {
    NodeArray values;
    for (const auto& value : *array) values.push_back(convert(value, file));
    out.value = std::move(values);
  } else if (const auto* text = node.as_string()) {
    out.value = text->get();
  } else if (const auto* integer = node.as_integer()) {
    out.value = integer->get();
  } else if (const auto* number = node.as_floating_point()) {
    out.value = number->get();
  } else if (const auto* flag = node.as_boolean()) {
    out.value = flag->get();
  }
  return out;
}

}  // namespace

std::string Node::kind() const {
  if (as<bool>()) return "a boolean";
  if (as<std::int64_t>()) return "an integer";
  if (as<double>()) return "a number";
  if (as<std::string>()) return "a string";
  if (as<NodeArray>()) return "an array";
  if (as<NodeTable>()) return "a table";
  return "a date or time";
}

Node parse_toml(const std::string& text, const std::string& name) {
  const auto file = std::make_shared<const std::string>(name);
  try {
    return convert(toml::parse(text, name), file);
  } catch (const toml::parse_error& error) {
    fail(place_of(error.source(), file), "not valid TOML: " + std::string(error.description()));
  }
}

Node parse_toml(const std::filesystem::path& file) {
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    throw InputError(file.string() + ": is a directory; give a scene file (.toml)");
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw InputError(file.string() + ": cannot open the scene file; check the name and where you run from");
  std::ostringstream text;
  text << in.rdbuf();
  return parse_toml(text.str(), file.string());
}

}  // namespace taut::bench
