#pragma once
/// \file
/// What there is to choose from, from the library's registries: for the terminal and for the documents.

#include <lib/text_table.hpp>
#include <string>
#include <vector>

namespace taut::bench {

/// "formulations", "operators", "kernels", "materials", "neighbours", "integrators", and "keys": those of
/// formulations and operators that a run may give.
std::vector<std::string> list_kinds();
/// One of these as a table. \throws InputError listing the kinds.
TextTable list_of(const std::string& kind);
/// A list for the terminal.
std::string listing(const TextTable& table);
/// A table as it stands in README.md and bench/scenes/README.md; tests compare them.
std::string markdown(const TextTable& table);

}  // namespace taut::bench
