#pragma once
/// \file
/// report.html: what was run, what came out, what it cost.

#include <filesystem>
#include <lib/case.hpp>
#include <lib/chart.hpp>
#include <lib/html.hpp>
#include <string>
#include <vector>

namespace taut::bench {

struct SceneReport {
  const Scene* scene;
  std::vector<CaseResult> cases;
};

struct Report {
  std::string executable;
  int threads = 1;
  bool quick = false;
  double wall_s = 0;
  std::vector<SceneReport> scenes;
  std::size_t unfinished = 0;  ///< cases that were not run, for the job was interrupted
};

/// Writes a chart to OUT/charts and puts it on the page; without gnuplot a note stands there instead, and
/// what could not be drawn, and why, is added to `missing`. \throws RunError
void add_chart(HtmlPage& page, const Chart& chart, const std::filesystem::path& out,
               std::vector<std::string>& missing);

/// Writes report.html, cases.csv, charts/ and pictures/ under `out`. Returns what could not be drawn, and
/// why. \throws RunError
std::vector<std::string> write_report(const Report& report, const std::filesystem::path& out);

}  // namespace taut::bench
