#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <lib/csv_table.hpp>
#include <lib/files.hpp>
#include <lib/terminal.hpp>
#include <sstream>
#include <taut/base/error.hpp>

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

/// Without the mark that spreadsheets put before UTF-8. \throws InputError for what is too large to be meant
std::string text_of(const std::filesystem::path& file) {
  constexpr std::size_t most = std::size_t{64} << 20;
  try {
    std::string text = read_file(file, most);
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    return text;
  } catch (const RunError& error) {
    throw InputError(error.what());
  }
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& file) : file_(file.string()) {
  if (!std::ifstream(file) || std::filesystem::is_directory(file))
    throw InputError(file_ + ": cannot open the table");
  std::istringstream in(text_of(file));
  std::string line;
  for (unsigned number = 1; std::getline(in, line); ++number) {
    const std::vector<std::string> fields = split(line);
    if (line.starts_with('#') || (fields.size() == 1 && fields[0].empty())) continue;
    if (header_.empty()) {
      header_ = fields;
      std::vector<std::string> sorted = fields;
      std::sort(sorted.begin(), sorted.end());
      if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
        throw InputError(fmt::format("{}:{}: has two columns '{}'", file_, number, brief(*twice)));
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
        throw InputError(fmt::format("{}:{}: column {}: '{}' is not a finite number", file_, number,
                                     brief(header_[c]), brief(text)));
      row.push_back({value, false});
    }
    cells_.push_back(std::move(row));
    lines_.push_back(number);
  }
  if (header_.empty()) throw InputError(file_ + ": has no header line with column names");
}

std::size_t CsvTable::column(const std::string& name) const {
  const auto found = std::find(header_.begin(), header_.end(), name);
  if (found == header_.end())
    throw InputError(fmt::format("{}: has no column '{}'; valid: {}", file_, name,
                                 brief(fmt::format("{}", fmt::join(header_, ", ")), 2000)));
  return static_cast<std::size_t>(found - header_.begin());
}

}  // namespace taut::bench
