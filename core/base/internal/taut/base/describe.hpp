#pragma once
/// \file
/// Positions in messages.

#include <fmt/format.h>

#include <string>
#include <taut/base/types.hpp>

namespace taut {

/// "(0.1, 0.25)".
template <int D>
std::string describe(const Vec<D>& X) {
  std::string text = "(";
  for (int d = 0; d < D; ++d) text += fmt::format("{}{:g}", d ? ", " : "", X[d]);
  return text + ")";
}

}  // namespace taut
