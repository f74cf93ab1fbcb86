#pragma once
/// \file
/// The registry of neighbour searches.

#include <string>
#include <taut/base/registry.hpp>
#include <taut/neighbors/search.hpp>

namespace taut {

/// A way to find pairs. All give the same lists, bit for bit; a program cannot add its own.
struct SearchEntry {
  std::string name;
  std::string line;
  SearchMethod method;
};
const Registry<SearchEntry>& search_registry();

}  // namespace taut
