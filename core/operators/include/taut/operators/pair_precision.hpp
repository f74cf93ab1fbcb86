#pragma once
/// \file
/// How what operators store is kept.

#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// How the pair vectors of the total Lagrangian operators are kept. State and sums are always double.
enum class PairPrecision {
  single_precision,  ///< stored as floats: 4 D bytes a pair
  double_precision,  ///< stored as doubles: 8 D bytes a pair
  shared,  ///< in double, once for all slots of the pair list that are alike: next to nothing on a lattice
  recomputed,  ///< from reference positions and a kernel table (1e-9) in every step: no bytes, more
               ///< arithmetic
  automatic    ///< `shared` where most slots are alike, else `single_precision`
};

/// "single", "double", "shared", "recomputed" or "automatic". \throws InputError naming the valid ones.
PairPrecision pair_precision(std::string_view name);
const char* to_string(PairPrecision precision);
std::vector<std::string> pair_precision_names();

}  // namespace taut
