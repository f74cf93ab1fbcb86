#include <fmt/format.h>

#include <fstream>
#include <lib/files.hpp>
#include <lib/html.hpp>
#include <scaling/page.hpp>
#include <scaling/summary.hpp>
#include <taut/base/error.hpp>
#include <thread>

namespace taut::bench {
namespace {

std::string processor() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

constexpr const char* vector_instructions =
#if defined(__AVX512F__)
    "AVX-512";
#elif defined(__AVX2__)
    "AVX2";
#elif defined(__x86_64__)
    "SSE2";
#else
    "the target's own vectors";
#endif

constexpr const char* compiler =
#if defined(__clang__)
    "clang++ " __clang_version__;
#else
    "g++ " __VERSION__;
#endif

std::string markdown(const SummaryTable& table) {
  std::string text = fmt::format("## {}\n\n{}\n\n|", table.title, table.note);
  for (const std::string& head : table.header) text += ' ' + head + " |";
  text += "\n|";
  for (std::size_t c = 0; c < table.header.size(); ++c) text += c ? "--:|" : "---|";
  for (const auto& row : table.rows) {
    text += "\n|";
    for (const std::string& cell : row) text += ' ' + cell + " |";
  }
  return text + "\n\n";
}

}  // namespace

std::string machine_description() {
  return fmt::format("{}, {} hardware threads; {}, {}", processor(), std::thread::hardware_concurrency(),
                     compiler, vector_instructions);
}

std::vector<std::string> write_scaling_report(const std::vector<Row>& rows, const std::string& machine,
                                              bool quick, const std::filesystem::path& out) {
  HtmlPage page("taut-scaling: how fast, and how near to the limit");
  page.paragraph(machine + (quick ? ". This is the quick version (--quick): fewer cases and repeats." : "."),
                 "quiet");
  std::vector<std::string> missing;
  for (const Chart& chart : scaling_charts(rows)) {
    std::string why;
    if (write_chart(chart, out / "charts", why)) {
      page.figure(out / "charts" / (chart.name + ".svg"), chart.title + ". " + chart.caption);
    } else {
      missing.push_back("charts/" + chart.name + ".svg: " + why);
      page.paragraph(
          fmt::format("{}: no chart ({}); its numbers are in charts/{}.csv.", chart.title, why, chart.name),
          "quiet");
    }
  }
  for (const SummaryTable& table : scaling_tables(rows)) {
    page.heading(2, table.title);
    page.paragraph(table.note, "quiet");
    std::vector<std::vector<HtmlCell>> cells;
    for (const auto& row : table.rows) {
      cells.emplace_back();
      for (std::size_t c = 0; c < row.size(); ++c) cells.back().push_back({row[c], c ? "number" : ""});
    }
    page.table(table.header, cells);
  }
  page.paragraph(
      "All numbers are in results.csv: a row each for the median, least (_min) and most (_max) of the "
      "repeats.",
      "quiet");
  write_file(out / "report.html", page.str());
  return missing;
}

void write_performance_page(const std::filesystem::path& page, const std::filesystem::path& results) {
  const std::vector<Row> rows = read_results(results);
  const std::filesystem::path folder = page.parent_path();
  std::string text =
      "# Performance\n\n"
      "Generated from results.csv of `taut-scaling` by `taut-scaling --page bench/PERFORMANCE.md`; do not "
      "edit. "
      "The last part is bench/performance-tried.md.\n\n";
  if (const auto machine = results.parent_path() / "machine.txt"; std::filesystem::exists(machine))
    text += "Measured on: " + read_file(machine) + "\n";
  const Chart chart = roofline(rows);
  if (!chart.empty()) {
    std::string why;
    const std::filesystem::path charts = results.parent_path() / "charts";
    if (!write_chart(chart, charts, why)) throw RunError("cannot draw the roofline: " + why);
    make_folder(folder / "pictures");
    std::filesystem::copy_file(charts / "roofline.svg", folder / "pictures/roofline.svg",
                               std::filesystem::copy_options::overwrite_existing);
    text += "## What limits each loop\n\n![Roofline](pictures/roofline.svg)\n\n" + chart.caption + "\n\n";
  }
  for (const SummaryTable& table : scaling_tables(rows)) text += markdown(table);
  if (const auto tried = folder / "performance-tried.md"; std::filesystem::exists(tried))
    text += read_file(tried);
  write_file(page, text);
}

}  // namespace taut::bench
