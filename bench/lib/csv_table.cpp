#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <lib/csv_table.hpp>
#include <taut/core/error.hpp>

namespace taut::bench {
namespace {

std::vector<std::string> split(const std::string& line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',')
      fields.emplace_back();
    else if (c != '\r' && !((c == ' ' || c == '\t') && fields.back().empty()))
      fields.back() += c;
  }
  for (std::string& field : fields)
    while (!field.empty() && (field.back() == ' ' || field.back() == '\t')) field.pop_back();
  return fields;
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file) : file_(file.string()) {
  std::ifstream in(file);
  if (!in || std::filesystem::is_directory(file)) throw InputError(file_ + ": cannot open the table");
  std::string line;
  for (unsigned number = 1; std::getline(in, line); ++number) {
    const std::vector<std::string> fields = split(line);
    if (line.starts_with('#') || (fields.size() == 1 && fields[0].empty())) continue;
    if (header_.empty()) {
      header_ = fields;
      continue;
    }
    if (fields.size() != header_.size())
      throw InputError(fmt::format("{}:{}: has {} fields, but the header has {}", file_, number,
                                   fields.size(), header_.size()));
    std::vector<Cell> row;
    for (std::size_t c = 0; c < fields.size(); ++c) {
      const std::string& text = fields[c];
      if (text.empty() || text == "-") {
        row.push_back({{}, text == "-"});
        continue;
      }
      double value = 0;
      const char* begin = text.data() + (text[0] == '+');
      const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
      if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        throw InputError(
            fmt::format("{}:{}: column {}: '{}' is not a finite number", file_, number, header_[c], text));
      row.push_back({value, false});
    }
    cells_.push_back(std::move(row));
  }
  if (header_.empty()) throw InputError(file_ + ": has no header line with column names");
}

std::size_t CsvTable::column(const std::string& name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end())
    throw InputError(fmt::format("{}: has no column '{}'; valid: {}", file_, name, fmt::join(header_, ", ")));
  return static_cast<std::size_t>(found - header_.begin());
}

}  // namespace taut::bench
