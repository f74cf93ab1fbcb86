#include <toml++/toml.h>

#include <fstream>
#include <lib/files.hpp>
#include <lib/toml_node.hpp>

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

namespace {

/// Largest scene file, and parts of a dotted key: toml++ recurses for each part until the stack ends.
constexpr std::size_t most_bytes = std::size_t{8} << 20;
constexpr unsigned most_dots = 16;

/// Looks for what the parser cannot be given. \throws InputError
void check_depth(const std::string& text, const std::shared_ptr<const std::string>& file) {
  Place place{file, 1, 0};
  unsigned dots = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    ++place.column;
    const auto newline = [&] {
      ++place.line;
      place.column = 0;
      dots = 0;
    };
    if (c == '\n') {
      newline();
    } else if (c == '#') {
      while (i + 1 < text.size() && text[i + 1] != '\n') ++i;
    } else if (c == '"' || c == '\'') {
      // Over the string; in three quotes it goes on over the ends of lines.
      const bool three = text.compare(i, 3, std::string(3, c)) == 0;
      const std::string end(three ? 3 : 1, c);
      std::size_t at = i + end.size();
      while (at < text.size() && text.compare(at, end.size(), end) != 0 && (three || text[at] != '\n')) {
        if (text[at] == '\n') ++place.line, place.column = 0;
        at += c == '"' && text[at] == '\\' && at + 1 < text.size() && text[at + 1] != '\n' ? 2 : 1;
      }
      if (at < text.size() && text[at] == '\n')
        i = at - 1;  // not closed: the parser says so
      else
        i = at + end.size() - 1;
      if (three) dots = 0;
    } else if (c == '.') {
      if (++dots > most_dots)
        fail(place, "not valid here: a key of more than " + std::to_string(most_dots + 1) + " parts");
    } else if (c == '=' || c == ',' || c == '[' || c == ']' || c == '{' || c == '}') {
      dots = 0;
    }
  }
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
  check_depth(text, file);
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
  if (!std::ifstream(file))
    throw InputError(file.string() + ": cannot open the scene file; check the name and where you run from");
  std::string text;
  try {
    text = read_file(file, most_bytes);
  } catch (const Error& error) {
    fail({std::make_shared<const std::string>(file.string()), 1, 1},
         std::string("no scene file: ") + error.what());
  }
  return parse_toml(text, file.string());
}

}  // namespace taut::bench
