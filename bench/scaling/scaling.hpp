#pragma once
/// \file
/// The job of taut-scaling.

#include <cstdint>
#include <filesystem>
#include <lib/common_options.hpp>
#include <string>
#include <vector>

namespace taut::bench {

struct ScalingOptions {
  std::vector<std::string> parts;       ///< empty: all
  std::vector<std::int64_t> particles;  ///< empty: 10^4, 10^5, 10^6
  std::vector<int> neighbours;          ///< empty: 18, 32, 56, 80
  bool large = false;                   ///< 10^7 particles as well
  int repeats = 0;                      ///< 0: 7, or 3 when quick
  std::filesystem::path page;           ///< instead of measuring, write this page …
  std::filesystem::path from;           ///< … from this results.csv; empty: the one in the output folder
};

/// "stream", "steps", …, in the order in which they run.
const std::vector<std::string>& scaling_parts();

/// Measures and writes results.csv, report.html and charts/ under the output folder.
/// \throws InputError for unknown parts and counts that no cube has, listing the valid ones; RunError
void run_scaling(const CommonOptions& common, const ScalingOptions& options);

}  // namespace taut::bench
