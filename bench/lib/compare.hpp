#pragma once
/// \file
/// The job of taut-compare.

#include <lib/common_options.hpp>
#include <optional>
#include <string>
#include <vector>

namespace taut::bench {

struct CompareOptions {
  std::vector<std::string> scenes;
  bool no_fields = false;
  bool dry_run = false;             ///< print what each case would take, and run none
  double max_memory = 0;            ///< [bytes]; 0: what there is
  std::optional<double> tolerance;  ///< search the cheapest method that meets it instead; see tolerance.hpp
};

/// Checks all scenes first, then runs every case and writes results.csv, runs.csv, report.html, charts/,
/// pictures/, histories/ and fields/ under the output folder. \throws InputError before anything is written;
/// RunError
/// With a tolerance: as `run_tolerance`.
void run_compare(const CommonOptions& common, const CompareOptions& options);

}  // namespace taut::bench
