#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/table_reader.hpp>
#include <map>

namespace taut::bench {

std::string join(const std::vector<std::string>& names) { return fmt::format("{}", fmt::join(names, ", ")); }

TableReader::TableReader(const Node& node, std::string table, const std::vector<std::string>& keys)
    : node_(node), table_(std::move(table)), values_(node.as<NodeTable>()) {
  if (!values_) fail(node.place, fmt::format("[{}] must be a table, but is {}", table_, node.kind()));
  for (const Node& entry : values_->entries)
    if (std::find(keys.begin(), keys.end(), entry.key) == keys.end())
      fail(entry.place, fmt::format("[{}] has no key '{}'; valid: {}", table_, brief(entry.key), join(keys)));
}

const Node* TableReader::find(const std::string& key) const {
  for (const Node& entry : values_->entries)
    if (entry.key == key) return &entry;
  return nullptr;
}

const Node& TableReader::require(const std::string& key) const {
  if (const Node* node = find(key)) return *node;
  fail(node_.place, fmt::format("[{}] needs the key '{}'", table_, key));
}

void TableReader::fail_at(const std::string& key, const std::string& what) const {
  const Node* node = find(key);
  fail(node ? node->place : node_.place, fmt::format("[{}] {}: {}", table_, key, what));
}

std::string TableReader::text_of(const Node& node, const std::string& key, std::size_t most,
                                 bool lines) const {
  const auto* text = node.as<std::string>();
  const auto refuse = [&](const std::string& what) {
    fail(node.place, fmt::format("[{}] {}: {}", table_, key, what));
  };
  if (!text) refuse("must be a string, but is " + node.kind());
  if (text->empty()) refuse("must not be empty");
  if (text->size() > most)
    refuse(fmt::format("has {} bytes, but may have {} at most: '{}'", text->size(), most, brief(*text)));
  std::string rest = *text;
  if (lines) std::erase_if(rest, [](char c) { return c == '\n' || c == '\r' || c == '\t'; });
  if (visible(rest) != rest || (!lines && rest.find_first_of("\n\t") != rest.npos))
    refuse(fmt::format("holds a control character: '{}'", brief(*text)));
  return *text;
}

std::string TableReader::text(const std::string& key) const { return text_of(require(key), key, 200, false); }

std::string TableReader::prose(const std::string& key, const std::string& fallback) const {
  return has(key) ? text_of(require(key), key, 20000, true) : fallback;
}

void TableReader::check_distinct(const std::string& key, const std::vector<double>& values) const {
  std::map<std::string, double> taken;
  for (const double value : values) {
    const auto [found, added] = taken.insert({fmt::format("{:.12g}", value + 0.0), value});
    if (!added)
      fail_at(key, found->second == value
                       ? fmt::format("lists {} twice", value)
                       : fmt::format("lists {} and {}, which are the same to twelve digits", found->second,
                                     value));
  }
}

std::string TableReader::text(const std::string& key, const std::string& fallback) const {
  return has(key) ? text(key) : fallback;
}

std::string TableReader::choice(const std::string& key, const std::vector<std::string>& valid) const {
  std::string name = text(key);
  if (std::find(valid.begin(), valid.end(), name) == valid.end())
    fail_at(key, fmt::format("unknown name '{}'; valid: {}", brief(name), join(valid)));
  return name;
}

std::string TableReader::choice(const std::string& key, const std::vector<std::string>& valid,
                                const std::string& fallback) const {
  return has(key) ? choice(key, valid) : fallback;
}

double TableReader::number_of(const Node& node, const std::string& key, const Range& range) const {
  double value = 0;
  if (const auto* number = node.as<double>())
    value = *number;
  else if (const auto* integer = node.as<std::int64_t>())
    value = static_cast<double>(*integer);
  else
    fail(node.place, fmt::format("[{}] {}: must be a number, but is {}", table_, key, node.kind()));
  if (!std::isfinite(value))
    fail(node.place, fmt::format("[{}] {}: must be finite, but is {}", table_, key, value));
  if (!range.contains(value))
    fail(node.place, fmt::format("[{}] {}: is {:g}, but must be {}", table_, key, value, range.str()));
  return value;
}

double TableReader::number(const std::string& key, const Range& range) const {
  return number_of(require(key), key, range);
}

double TableReader::number(const std::string& key, const Range& range, double fallback) const {
  return has(key) ? number(key, range) : fallback;
}

std::int64_t TableReader::integer(const std::string& key, std::int64_t min, std::int64_t max) const {
  const Node& node = require(key);
  const auto* value = node.as<std::int64_t>();
  if (!value) fail_at(key, "must be an integer, but is " + node.kind());
  if (*value < min || *value > max) fail_at(key, fmt::format("is {}, but must be {} … {}", *value, min, max));
  return *value;
}

std::int64_t TableReader::integer(const std::string& key, std::int64_t min, std::int64_t max,
                                  std::int64_t fallback) const {
  return has(key) ? integer(key, min, max) : fallback;
}

ParameterValue TableReader::value(const Parameter& parameter) const {
  if (parameter.type == Parameter::Type::choice) return choice(parameter.name, parameter.choices());
  const double number = this->number(parameter.name, parameter.range);
  if (parameter.type == Parameter::Type::whole && number != std::floor(number))
    fail_at(parameter.name, fmt::format("is {:g}, but must be a {}", number, parameter.domain()));
  return number;
}

std::vector<double> TableReader::vector(const std::string& key, std::size_t size) const {
  const Node& node = require(key);
  const auto* array = node.as<NodeArray>();
  if (!array || array->size() != size)
    fail_at(key, fmt::format("must be an array of {} number{}, but is {}", size, size == 1 ? "" : "s",
                             array ? fmt::format("an array of {}", array->size()) : node.kind()));
  std::vector<double> values;
  for (const Node& entry : *array) values.push_back(number_of(entry, key, Range::any()));
  return values;
}

std::vector<double> TableReader::numbers(const std::string& key, const Range& range) const {
  const Node& node = require(key);
  const auto* array = node.as<NodeArray>();
  if (!array) return {number_of(node, key, range)};
  if (array->empty()) fail_at(key, "must list at least one number");
  std::vector<double> values;
  for (const Node& entry : *array) values.push_back(number_of(entry, key, range));
  return values;
}

std::vector<std::string> TableReader::texts(const std::string& key) const {
  const Node& node = require(key);
  const auto* array = node.as<NodeArray>();
  if (!array) return {text(key)};
  if (array->empty()) fail_at(key, "must list at least one name");
  std::vector<std::string> values;
  for (const Node& entry : *array) {
    values.push_back(text_of(entry, key, 200, false));
  }
  return values;
}

const NodeArray& TableReader::tables(const std::string& key) const {
  const Node& node = require(key);
  const auto* array = node.as<NodeArray>();
  if (!array) fail_at(key, fmt::format("must be an array of tables ([[{}]]), but is {}", key, node.kind()));
  if (array->empty()) fail_at(key, "must have at least one entry");
  return *array;
}

}  // namespace taut::bench
