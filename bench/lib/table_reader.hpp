#pragma once
/// \file
/// Typed, checked access to the keys of one table of a scene.

#include <lib/toml_node.hpp>
#include <optional>
#include <string>
#include <taut/base/parameters.hpp>
#include <vector>

namespace taut::bench {

/// Numbers a key takes.
using Range = Interval;

/// "a, b, c".
std::string join(const std::vector<std::string>& names);

/// Every failure is an InputError "file:line:column: [table] key: what was wrong; what is valid".
class TableReader {
 public:
  /// `node` must be a table whose keys are all among `keys`.
  TableReader(const Node& node, std::string table, const std::vector<std::string>& keys);

  const Place& place() const { return node_.place; }
  const std::string& table() const { return table_; }
  const Node* find(const std::string& key) const;
  const Node& require(const std::string& key) const;
  bool has(const std::string& key) const { return find(key) != nullptr; }

  /// One line, not empty, of up to 200 bytes, without control characters.
  std::string text(const std::string& key) const;
  std::string text(const std::string& key, const std::string& fallback) const;
  /// Text with line breaks, of up to 20000 bytes.
  std::string prose(const std::string& key, const std::string& fallback) const;
  /// Twelve digits tell numbers apart in names and tables. \throws InputError for two that are the same
  void check_distinct(const std::string& key, const std::vector<double>& values) const;
  std::string choice(const std::string& key, const std::vector<std::string>& valid) const;
  std::string choice(const std::string& key, const std::vector<std::string>& valid,
                     const std::string& fallback) const;
  double number(const std::string& key, const Range& range) const;
  double number(const std::string& key, const Range& range, double fallback) const;
  std::int64_t integer(const std::string& key, std::int64_t min, std::int64_t max,
                       std::int64_t fallback) const;
  std::int64_t integer(const std::string& key, std::int64_t min, std::int64_t max) const;
  /// The value of a parameter, in its range or one of its choices.
  ParameterValue value(const Parameter& parameter) const;
  /// Exactly `size` numbers.
  std::vector<double> vector(const std::string& key, std::size_t size) const;
  /// One number or a non-empty array of them.
  std::vector<double> numbers(const std::string& key, const Range& range) const;
  /// One string or a non-empty array of them.
  std::vector<std::string> texts(const std::string& key) const;
  /// A non-empty array of tables.
  const NodeArray& tables(const std::string& key) const;

  [[noreturn]] void fail_at(const std::string& key, const std::string& what) const;

 private:
  std::string text_of(const Node& node, const std::string& key, std::size_t most, bool lines) const;
  double number_of(const Node& node, const std::string& key, const Range& range) const;

  const Node& node_;
  std::string table_;
  const NodeTable* values_ = nullptr;
};

}  // namespace taut::bench
