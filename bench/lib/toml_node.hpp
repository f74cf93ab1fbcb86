#pragma once
/// \file
/// A parsed TOML document as plain values that know their place, so that one file alone includes toml++.

#include <cstdint>
#include <filesystem>
#include <lib/place.hpp>
#include <string>
#include <variant>
#include <vector>

namespace taut::bench {

struct Node;
using NodeArray = std::vector<Node>;
/// Entries with their `key`, in the order of the keys.
struct NodeTable {
  std::vector<Node> entries;
};
struct OtherNode {};  ///< dates and times: no key takes them

struct Node {
  Place place;
  std::string key;  ///< of an entry of a table
  std::variant<OtherNode, bool, std::int64_t, double, std::string, NodeArray, NodeTable> value;

  template <class T>
  const T* as() const {
    return std::get_if<T>(&value);
  }
  /// "a string", "a table", … for messages.
  std::string kind() const;
};

/// \throws InputError for a missing file, and file:line:column for what is not TOML.
Node parse_toml(const std::filesystem::path& file);
/// The same from text; `name` stands for the file in messages. \throws InputError
Node parse_toml(const std::string& text, const std::string& name);

}  // namespace taut::bench
