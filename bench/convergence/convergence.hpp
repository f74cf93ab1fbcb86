#pragma once
/// \file
/// The job of taut-convergence.

#include <convergence/study.hpp>
#include <string>
#include <vector>

namespace taut::bench {

/// Names of the studies, in the order in which they run.
std::vector<std::string> study_names();

/// Runs the named studies (all where none is named), prints their tables and writes results.csv, report.html
/// and charts/ under the output folder; results.csv after each study. \throws InputError for an unknown study
/// or a scene that cannot be read; RunError
void run_convergence(const StudyOptions& options, const std::vector<std::string>& studies);

}  // namespace taut::bench
