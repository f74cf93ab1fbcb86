#include <fmt/format.h>

#include <algorithm>
#include <lib/text_table.hpp>

namespace taut::bench {
namespace {

/// Characters of UTF-8 text.
std::size_t width(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

}  // namespace

std::string signed_percent(double error, int digits) {
  std::string text = fmt::format("{:+.{}f}", 100 * error, digits);
  if (text.find_first_not_of("+-0.") == text.npos) text.erase(0, 1);
  return text + " %";
}

std::string plain(const TextTable& table) {
  std::vector<std::size_t> widths;
  for (const std::string& h : table.header) widths.push_back(width(h));
  for (const auto& row : table.rows)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width(row[c].text));

  const auto line = [&](auto&& cell_text, auto&& to_right) {
    std::string text;
    for (std::size_t c = 0; c < widths.size(); ++c) {
      const std::string cell = cell_text(c), space(widths[c] - width(cell), ' ');
      text += "  " + (to_right(c) ? space + cell : cell + space);
    }
    while (text.ends_with(' ')) text.pop_back();
    return text + '\n';
  };
  const auto number = [&](std::size_t c) {
    return !table.rows.empty() && table.rows[0][c].kind.find("number") != std::string::npos;
  };
  std::string text = table.title + '\n' + line([&](std::size_t c) { return table.header[c]; }, number);
  for (const auto& row : table.rows)
    text += line([&](std::size_t c) { return row[c].text; },
                 [&](std::size_t c) { return row[c].kind.find("number") != std::string::npos; });
  return table.note.empty() ? text : text + "  " + table.note + '\n';
}

}  // namespace taut::bench
