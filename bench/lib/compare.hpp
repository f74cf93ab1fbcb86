#pragma once
/// \file
/// The job of taut-compare.

#include <lib/options.hpp>
#include <string>
#include <vector>

namespace taut::bench {

struct CompareOptions {
  std::vector<std::string> scenes;
  bool no_fields = false;
};

/// Checks all scenes first, then runs every case and writes results.csv, runs.csv, report.html, charts/,
/// pictures/, histories/ and fields/ under the output folder. \throws InputError before anything is written;
/// RunError
void run_compare(const CommonOptions& common, const CompareOptions& options);

}  // namespace taut::bench
