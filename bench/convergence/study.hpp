#pragma once
/// \file
/// What a study of taut-convergence is: runs in, tables, charts and rows out.

#include <filesystem>
#include <lib/chart.hpp>
#include <lib/common_options.hpp>
#include <lib/results.hpp>
#include <lib/text_table.hpp>
#include <string>
#include <vector>

namespace taut::bench {

struct StudyOptions {
  CommonOptions common;
  std::filesystem::path scenes;  ///< folder of the scene files that studies start from
};

/// What a study found.
struct Section {
  std::string title;
  std::vector<std::string> text;  ///< paragraphs
  std::vector<TextTable> tables;
  std::vector<Chart> charts;
  std::vector<Row> rows;  ///< of results.csv
};

/// The swinging cube under every formulation, operator and support that can run it (case A6), beside finite
/// elements.
Section study_cube(const StudyOptions& options);
/// The cantilever at its largest load under refinement, and with zero-energy control (case B1).
Section study_cantilever(const StudyOptions& options);
/// Stress concentration at a hole (case A5).
Section study_sheet(const StudyOptions& options);
/// What more iterations buy in the set-up of compatible operators.
Section study_iterations(const StudyOptions& options);
/// Error against cost, over operators, supports, kernels, spacings and pair precisions.
Section study_frontier(const StudyOptions& options);

}  // namespace taut::bench
