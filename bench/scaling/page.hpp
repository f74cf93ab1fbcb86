#pragma once
/// \file
/// What a job of taut-scaling leaves to read.

#include <filesystem>
#include <lib/results.hpp>
#include <string>
#include <vector>

namespace taut::bench {

/// The processor, its vector instructions in this build, and the compiler: one line.
std::string machine_description();

/// report.html and charts/ under `out`. Returns what could not be drawn, and why. \throws RunError
std::vector<std::string> write_scaling_report(const std::vector<Row>& rows, const std::string& machine,
                                              bool quick, const std::filesystem::path& out);

/// The page of the repository: `page` (Markdown), the roofline as pictures/roofline.svg beside it, and at its
/// end what performance-tried.md beside it says, where there is one. Rows come from `results`, the machine
/// from machine.txt beside them. \throws InputError for results that cannot be read; RunError
void write_performance_page(const std::filesystem::path& page, const std::filesystem::path& results);

}  // namespace taut::bench
