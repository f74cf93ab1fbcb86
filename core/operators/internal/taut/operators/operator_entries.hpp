#pragma once
/// \file
/// Entries of taut's own operators, each defined in the file of what it names.

#include <taut/operators/registry.hpp>

namespace taut {

OperatorEntry standard_entry();
OperatorEntry corrected_entry();
OperatorEntry compatible_entry();
OperatorEntry antisymmetric_entry();
OperatorEntry quadratic_entry();

/// The parameter that those share which closure is made for.
Parameter closure_iterations();

}  // namespace taut
