#pragma once
/// \file
/// How studies name methods.

#include <fmt/format.h>

#include <lib/results.hpp>
#include <string>
#include <taut/core/method.hpp>

namespace taut::bench {

/// Formulation (the common one goes without saying), operators, support, and zero-energy control where it is
/// on.
inline std::string label_of(const Method& m) {
  const std::string formulation = m.formulation == "tl_displacement" ? "" : m.formulation + ", ";
  return fmt::format("{}{}, {:g} dx{}", formulation, m.operators, m.support_dx,
                     m.zero_energy_control > 0 ? fmt::format(", control {:g}", *m.zero_energy_control) : "");
}

/// What a quantity's name gets where zero-energy control is on, for results.csv has no column for it.
inline std::string suffix_of(const Method& m) {
  return m.zero_energy_control > 0 ? "_control_" + snake_number(*m.zero_energy_control) : "";
}

}  // namespace taut::bench
