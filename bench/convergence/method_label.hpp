#pragma once
/// \file
/// How studies name methods.

#include <fmt/format.h>

#include <lib/names.hpp>
#include <lib/results.hpp>
#include <string>
#include <taut/formulations/auto_method.hpp>
#include <taut/operators/method.hpp>

namespace taut::bench {

/// Formulation (the common one goes without saying), operators and support where there are pairs, and
/// zero-energy control where it is given.
inline std::string label_of(const Method& m) {
  const std::string control =
      m.zero_energy_control ? fmt::format(", control {:g}", *m.zero_energy_control) : "";
  if (!has_pairs(m.formulation)) return m.formulation + control;
  const std::string formulation = m.formulation == with_defaults({}).formulation ? "" : m.formulation + ", ";
  return fmt::format("{}{}, {:g} dx{}", formulation, m.operators, m.support_dx, control);
}

/// What a quantity's name gets where zero-energy control is given, for results.csv has no column for it.
inline std::string suffix_of(const Method& m) {
  return m.zero_energy_control ? "_control_" + snake_number(*m.zero_energy_control) : "";
}

}  // namespace taut::bench
