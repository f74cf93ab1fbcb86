#pragma once
/// \file
/// The rows of taut-scaling as tables and charts, for report.html and for the page in the repository.

#include <lib/chart.hpp>
#include <lib/results.hpp>
#include <string>
#include <vector>

namespace taut::bench {

struct SummaryTable {
  std::string title, note;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

/// Those that the rows have something for: the machine's limits, steps, baselines, sizes and memory, dense
/// matrices, lists.
std::vector<SummaryTable> scaling_tables(const std::vector<Row>& rows);
/// Rate against particles, neighbours and threads, the fraction of the limit, baselines, lists; empty ones
/// left out.
std::vector<Chart> scaling_charts(const std::vector<Row>& rows);
/// Gflop/s against flops a byte, under the roofs of bandwidth and arithmetic (Williams, Waterman and
/// Patterson 2009), all threads.
Chart roofline(const std::vector<Row>& rows);

}  // namespace taut::bench
