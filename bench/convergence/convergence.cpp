#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <convergence/convergence.hpp>
#include <lib/files.hpp>
#include <lib/gnuplot.hpp>
#include <lib/progress.hpp>
#include <lib/report.hpp>
#include <lib/scene_loader.hpp>
#include <lib/terminal.hpp>
#include <taut/base/error.hpp>

namespace taut::bench {
namespace {

struct Entry {
  const char* name;
  Section (*run)(const StudyOptions&);
  const char* scene;  // file that it starts from, or null
};

constexpr const char* beam = "cantilever_convergence.toml";
constexpr Entry studies_in_order[] = {
    {"cube", study_cube, nullptr},      {"cantilever", study_cantilever, beam},
    {"sheet", study_sheet, nullptr},    {"iterations", study_iterations, beam},
    {"frontier", study_frontier, beam},
};

void write_section(HtmlPage& page, const Section& section, const std::filesystem::path& out,
                   std::vector<std::string>& missing) {
  page.heading(2, section.title);
  for (const std::string& text : section.text) page.paragraph(text);
  for (const Chart& chart : section.charts) add_chart(page, chart, out, missing);
  for (const TextTable& table : section.tables) {
    page.heading(3, table.title);
    page.table(table.header, table.rows);
    if (!table.note.empty()) page.paragraph(table.note, "quiet");
  }
}

/// One row more for each run that broke and has none yet: when.
std::vector<Row> with_breakdown_times(const std::vector<Row>& rows) {
  std::vector<Row> all = rows;
  const auto same = [](const Row& a, const Row& b) {  // a run: no two take the same time to the last digit
    return a.scene == b.scene && a.dx == b.dx && a.setup_s == b.setup_s && a.loop_s == b.loop_s;
  };
  for (const Row& row : rows) {
    if (row.status != "broke" || !row.time) continue;
    if (std::any_of(all.begin(), all.end(), [&](const Row& other) {
          return other.quantity.starts_with("breakdown_time") && same(row, other);
        }))
      continue;
    Row when = row;
    when.quantity = "breakdown_time";
    when.value = row.time;
    when.reference.reset(), when.error.reset();
    when.unit = "s";
    when.status = "ok";
    all.push_back(std::move(when));
  }
  return all;
}

}  // namespace

std::vector<std::string> study_names() {
  std::vector<std::string> all;
  for (const Entry& entry : studies_in_order) all.emplace_back(entry.name);
  return all;
}

void run_convergence(const StudyOptions& options, const std::vector<std::string>& studies) {
  const auto start = std::chrono::steady_clock::now();
  const auto valid = study_names();
  for (const std::string& name : studies)
    if (std::find(valid.begin(), valid.end(), name) == valid.end())
      throw InputError(fmt::format("unknown study \"{}\"; valid: {}", name, join_names(valid)));

  const auto chosen = [&](const Entry& entry) {
    return studies.empty() || std::find(studies.begin(), studies.end(), entry.name) != studies.end();
  };
  // A bad scene comes to light before the first run and the first file.
  for (const Entry& entry : studies_in_order)
    if (chosen(entry) && entry.scene) load_scene(options.scenes / entry.scene, options.common.quick);

  const CommonOptions& common = options.common;
  const OutputFolder folder(common.out);
  ProgressLine say(common.quiet, 1);
  std::vector<Row> rows;
  std::vector<std::string> missing;
  HtmlPage page("Convergence of operators and formulations");
  page.paragraph(
      fmt::format("taut-convergence {}, {} thread{}{}.", TAUT_VERSION, common.threads,
                  common.threads == 1 ? "" : "s",
                  common.quick ? ". This is the quick version (--quick): coarser, and with fewer seeds" : ""),
      "quiet");
  for (const Entry& entry : studies_in_order) {
    if (!chosen(entry)) continue;
    const Section section = entry.run(options);
    const std::vector<Row> complete = with_breakdown_times(section.rows);
    rows.insert(rows.end(), complete.begin(), complete.end());
    write_results(common.out / "results.csv", rows);
    write_section(page, section, common.out, missing);
    say.say("");
    for (const TextTable& table : section.tables) say.say(plain(table));
  }
  page.paragraph("The numbers are in results.csv, one row a quantity.", "quiet");
  write_file(common.out / "report.html", page.str());
  if (!gnuplot::available())
    say.say("gnuplot was not found: charts are left as tables (charts/*.csv).");
  else
    for (const std::string& what : missing) print_error("taut-convergence: cannot draw " + what + '\n');
  const double wall = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  say.say(fmt::format("{} rows in {:.1f} s. Look at {}", rows.size(), wall,
                      (common.out / "report.html").string()));
}

}  // namespace taut::bench
