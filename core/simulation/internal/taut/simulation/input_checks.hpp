#pragma once
/// \file
/// What a simulation asks of what it is given.

#include <taut/base/error.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/simulation/simulation.hpp>

namespace taut {

/// \throws InputError for a cloud whose parts do not go together or are no numbers, and for one that lies so
/// far from the origin that its coordinates do not tell its particles apart.
template <int D>
void check_cloud(const Cloud<D>& cloud);

/// \throws InputError for options out of range.
void check_options(double duration, const RunOptions& options);
void check_options(const RelaxOptions& options);

/// \throws InputError where a function that is to be called is none.
template <class Function>
void must_be_callable(const char* where, const char* what, const Function& f) {
  if (!f) throw InputError(std::string(where) + ": the " + what + " is an empty function");
}

}  // namespace taut
