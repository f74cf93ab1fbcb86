#pragma once
/// \file
/// Tables that go to the terminal and onto a page.

#include <lib/html.hpp>
#include <string>
#include <vector>

namespace taut::bench {

/// A table for the terminal and the report. Cells of kind "number" stand to the right.
struct TextTable {
  std::string title, note;
  std::vector<std::string> header;
  std::vector<std::vector<HtmlCell>> rows;
};
/// In plain text, columns lined up.
std::string plain(const TextTable& table);

/// A relative error, "+1.25 %"; without a sign where it rounds to zero.
std::string signed_percent(double error, int digits);

}  // namespace taut::bench
