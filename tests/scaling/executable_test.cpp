// taut-scaling as a program: its options, its files.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <lib/files.hpp>
#include <lib/results.hpp>
#include <program.hpp>
#include <scaling/row_query.hpp>
#include <string>

using namespace taut::bench;
using namespace taut::test;

namespace {

namespace fs = std::filesystem;

const fs::path& folder() {
  static const fs::path path = fresh_folder("scaling");
  return path;
}

Outcome scaling(const std::string& arguments) { return run_program(TAUT_SCALING, arguments, folder()); }

bool has(const std::vector<Row>& rows, const std::string& formulation, const std::string& quantity) {
  return std::any_of(rows.begin(), rows.end(), [&](const Row& r) {
    return r.formulation == formulation && r.quantity == quantity && r.value && *r.value > 0;
  });
}

}  // namespace

TEST_CASE("bad options are bad input, with what would be right") {
  Outcome outcome = scaling("--parts steps,nonsense");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("unknown part \"nonsense\"; valid: stream, steps, baselines, dense, lists") !=
        std::string::npos);
  outcome = scaling("--neighbours 19");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("valid: 18, 32, 56, 80") != std::string::npos);
  CHECK(scaling("--particles 10").status == 2);
  CHECK(scaling("--particles many").status == 2);
  CHECK(scaling("--repeats 0").status == 2);
  CHECK(scaling("--threads 0").status == 2);
  CHECK(scaling("--from results.csv").status == 2);
  outcome = scaling("--page page.md --from nowhere.csv");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("nowhere.csv") != std::string::npos);
  write_file(folder() / "other.csv", "a,b\n1,2\n");
  CHECK(scaling("--page page.md --from other.csv").status == 2);
  CHECK(!fs::exists(folder() / "page.md"));
  CHECK(!fs::exists(folder() / "out"));
  CHECK(scaling("--help").status == 0);
}

TEST_CASE("a run writes its rows, a report and the page of the repository") {
  const Outcome outcome = scaling(
      "--quick --repeats 2 --particles 1000 --parts stream,steps,baselines,lists --threads 1 --out run");
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  const std::vector<Row> rows = read_results(folder() / "run/results.csv");
  for (const char* quantity : {"rate", "rate_min", "rate_max", "setup", "bytes_per_step",
                               "fraction_of_peak_flops", "ratio_to_csr", "ratio_to_eigen"})
    CHECK(has(rows, "tl_displacement", quantity));
  for (const char* formulation : {"baseline_csr", "baseline_eigen"}) {
    CHECK(has(rows, formulation, "rate"));
    CHECK(has(rows, formulation, "acceleration_difference"));
  }
  CHECK(has(rows, "list_taut", "ratio_to_nanoflann"));
  CHECK(has(rows, "", "triad"));
  for (const Row& row : rows) {
    CHECK(row.status == "ok");
    CHECK(row.threads.value_or(1) == 1);
  }
  const auto rates = cases_of(rows, "rate", [](const Row&) { return true; });
  // Three payloads on the lattice, one on the jittered cloud, two baselines.
  CHECK(rates.size() == 6);
  for (const Row& row : rates) {
    CHECK(row.unit == "particle-steps/s");
    CHECK(row.particle_steps_per_s == row.value);
    CHECK(row.bytes_per_particle.value_or(0) > 100);
    CHECK(*value_of(rows, row, "rate_min") <= *row.value);
    CHECK(*row.value <= *value_of(rows, row, "rate_max"));
  }
  CHECK(read_file(folder() / "run/report.html").find("Against other ways to write the same step") !=
        std::string::npos);

  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) return;
  write_file(folder() / "bench/performance-tried.md", "## What was tried\n\nThis and that.\n");
  REQUIRE(scaling("--page bench/PERFORMANCE.md --from run/results.csv").status == 0);
  const std::string page = read_file(folder() / "bench/PERFORMANCE.md");
  CHECK(page.find("| plain") == std::string::npos);
  CHECK(page.find("## Pair lists against nanoflann") != std::string::npos);
  CHECK(page.ends_with("This and that.\n"));
  CHECK(read_file(folder() / "bench/pictures/roofline.svg").find("</svg>") != std::string::npos);
}

TEST_CASE("results are read as they were written") {
  Row row;
  row.scene = "a, \"b\"";
  row.support_dx = 0.1;
  row.particles = 12;
  row.quantity = "rate";
  row.value = 1.0 / 3;
  const fs::path file = folder() / "rows.csv";
  write_results(file, {row, Row{}});
  const std::vector<Row> rows = read_results(file);
  REQUIRE(rows.size() == 2);
  CHECK(results_line(rows[0]) == results_line(row));
  CHECK(rows[0].scene == row.scene);
  CHECK(results_line(rows[1]) == results_line(Row{}));
}
