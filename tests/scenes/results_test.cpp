#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <lib/csv_table.hpp>
#include <lib/files.hpp>
#include <lib/measure.hpp>
#include <lib/results.hpp>
#include <numbers>
#include <taut/base/error.hpp>

using namespace taut;
using namespace taut::bench;

namespace {

std::filesystem::path scratch(const std::string& name) {
  const auto folder = std::filesystem::temp_directory_path() / "taut-test-scenes";
  std::filesystem::create_directories(folder);
  return folder / name;
}

std::string csv_message(const std::string& content) {
  const auto file = scratch("table.csv");
  std::ofstream(file) << content;
  try {
    CsvTable table(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("results have the columns of the contract, in its order") {
  CHECK(results_header() ==
        "scene,formulation,operators,material,kernel,support_dx,dx,particles,pairs,threads,precision,"
        "integrator,steps,time,quantity,"
        "value,reference,error,unit,status,setup_s,loop_s,particle_steps_per_s,bytes_per_particle,label");
  Row row;
  row.scene = "truss";
  row.quantity = "tip, \"ux\"";
  row.value = 0.1;
  row.particles = 12;
  const std::string line = results_line(row);
  CHECK(line == "truss,,,,,,,12,,,,,,,\"tip, \"\"ux\"\"\",0.1,,,,ok,,,,,");
  const std::string header = results_header();
  CHECK(std::count(header.begin(), header.end(), ',') == 24);
  CHECK(results_header({"load", "nu"}) == header + ",load,nu");
}

TEST_CASE("labels and swept values have columns of their own, and are read back") {
  Row first, second;
  first.label = "a, \"b\"";
  first.swept = {{"nu", 0.4999999}};
  second.swept = {{"load", -3000}};
  write_results(scratch("rows.csv"), {first, second});
  CHECK(read_file(scratch("rows.csv")).starts_with(results_header({"load", "nu"}) + '\n'));
  const std::vector<Row> rows = read_results(scratch("rows.csv"));
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].label == "a, \"b\"");
  CHECK(rows[0].swept == first.swept);
  CHECK(rows[1].swept == second.swept);
}

TEST_CASE("swept values make snake_case names") {
  CHECK(snake_number(1000) == "1000");
  CHECK(snake_number(-7000) == "minus_7000");
  CHECK(snake_number(0.3) == "0_3");
  CHECK(snake_number(0) == "0");
  CHECK(snake_number(8e9) == "8000000000");
  CHECK(snake_number(1e-7) == "1e_minus_07");
  CHECK(snake_number(0.4999999) != snake_number(0.49999995));
}

TEST_CASE("errors are relative unless they cannot be") {
  CHECK(error_of(1.1, 1.0, false) == doctest::Approx(0.1));
  CHECK(error_of(-1.1, -1.0, false) == doctest::Approx(0.1));
  CHECK(error_of(1.1, 1.0, true) == doctest::Approx(0.1));
  CHECK(error_of(3.0, 2.0, true) == doctest::Approx(1.0));
  CHECK(error_of(0.5, 0.0, false) == doctest::Approx(0.5));
}

TEST_CASE("tables are read with their gaps") {
  const auto file = scratch("good.csv");
  std::ofstream(file) << "# comment\nload_N, ux_mm\n1000, 1.5\n\n-3000,-\n+5000,\r\n";
  const CsvTable table(file);
  REQUIRE(table.rows() == 3);
  const std::size_t ux = table.column("ux_mm");
  CHECK(table.at(0, ux).value == 1.5);
  CHECK(table.at(1, ux).broke);
  CHECK(!table.at(2, ux).value);
  CHECK(table.at(2, 0).value == 5000);
  CHECK_THROWS_AS(table.column("uy_mm"), InputError);
}

TEST_CASE("tables that hold no numbers are refused with file and line") {
  CHECK(csv_message("a,b\n1,nan\n").find("table.csv:2: column b: 'nan' is not a finite number") !=
        std::string::npos);
  CHECK(csv_message("a,b\n1,inf\n").find(":2:") != std::string::npos);
  CHECK(csv_message("a,b\n1,2\n3\n").find("table.csv:3: has 1 fields, but the header has 2") !=
        std::string::npos);
  CHECK(csv_message("a,b\n1,two\n").find("'two'") != std::string::npos);
  CHECK(csv_message("# nothing\n").find("no header") != std::string::npos);
  CHECK(csv_message("a,b,a\n1,2,3\n").find("table.csv:1: has two columns 'a'") != std::string::npos);
  CHECK(csv_message("a\n" + std::string(100000, 'x') + '\n').size() < 400);
}

TEST_CASE("F20: spreadsheets put a byte order mark before the header") {
  std::ofstream(scratch("bom.csv")) << "\xef\xbb\xbfload,ux\n1,2\n";
  CHECK(CsvTable(scratch("bom.csv")).column("load") == 0);
}

TEST_CASE("files are whole or not there") {
  const auto file = scratch("deep") / "er" / "text.txt";
  write_file(file, "first");
  write_file(file, "second");
  CHECK(read_file(file) == "second");
  CHECK(!std::filesystem::exists(file.string() + ".tmp"));
  CHECK_THROWS_AS(write_file(file / "below_a_file.txt", "x"), RunError);
  CHECK(file_name_of("truss ul_basic, load -3000") == "truss_ul_basic_load_-3000");
}

TEST_CASE("measures of a pulse") {
  // A raised cosine that passes between t = 1 and 3 with amplitude -2.
  Curve pulse, exact;
  for (int i = 0; i <= 407; ++i) {
    const double t = 0.01 * i;
    const bool inside = t >= 1 && t <= 3;
    pulse.t.push_back(t);
    pulse.value.push_back(inside ? -(1 - std::cos(std::numbers::pi * (t - 1))) : 0);
    exact.value.push_back(1.01 * pulse.value.back());
  }
  exact.t = pulse.t;
  ProbeSpec probe;
  probe.measure = "peak";
  CHECK(*measure(probe, pulse, exact) == doctest::Approx(-2).epsilon(1e-6));
  probe.measure = "arrival_time";
  CHECK(*measure(probe, pulse, exact) == doctest::Approx(1.5).epsilon(1e-4));
  probe.measure = "curve_error";
  CHECK(*measure(probe, pulse, exact) == doctest::Approx(0.01 / 1.01));
  probe.measure = "peak";
  probe.window = {3.5, 4};
  CHECK(*measure(probe, pulse, exact) == 0);
  probe.window = {10, 11};
  CHECK(!measure(probe, pulse, exact));
}

TEST_CASE("histories") {
  HistorySpec h;
  CHECK(h.factor(0) == 1);
  h = {"linear", 1, 2, {}};
  CHECK(h.factor(0.5) == 0);
  CHECK(h.factor(2) == 0.5);
  CHECK(h.factor(9) == 1);
  h.type = "smoothstep";
  CHECK(h.factor(1.5) == doctest::Approx(3 * 0.0625 - 2 * 0.015625));
  h.type = "raised_cosine";
  CHECK(h.factor(2) == doctest::Approx(1));
  CHECK(h.factor(1.5) == doctest::Approx(0.5));
  CHECK(h.factor(3.1) == 0);
  h.type = "square";
  CHECK(h.factor(1.1) == 1);
  CHECK(h.factor(3.1) == 0);
  h = {"table", 0, 0, {{0, 0}, {1, 2}, {3, 0}}};
  CHECK(h.factor(0.5) == 1);
  CHECK(h.factor(2) == 1);
  CHECK(h.factor(7) == 0);
}
