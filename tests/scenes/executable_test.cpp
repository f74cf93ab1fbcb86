#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <lib/files.hpp>
#include <program.hpp>
#include <scenes/malformed.hpp>
#include <sstream>
#include <taut/simulation/simulation.hpp>

using taut::bench::read_file;
using taut::test::fresh_folder;
using taut::test::Outcome;
using taut::test::run_program;

namespace {

namespace fs = std::filesystem;

const fs::path& folder() {
  static const fs::path path = fresh_folder("compare");
  return path;
}

/// Runs taut-compare in the test's folder.
Outcome compare(const std::string& arguments, const std::string& environment = "") {
  return run_program(TAUT_COMPARE, arguments, folder(), environment);
}

void write(const std::string& name, const std::string& text) { std::ofstream(folder() / name) << text; }

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::istringstream in(read_file(file));
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

/// Those of results.csv that are of probes, and the header.
std::vector<std::string> probe_rows(const fs::path& file) {
  std::vector<std::string> lines = lines_of(file);
  std::erase_if(lines, [](const std::string& line) { return line.find(",health_") != std::string::npos; });
  return lines;
}

}  // namespace

TEST_CASE("F14, F15, F19, F20: every malformed scene ends with exit code 2, a message and no files") {
  for (const taut::test::Mistake& mistake : taut::test::mistakes()) {
    CAPTURE(mistake.name);
    const std::string text = taut::test::with(mistake);
    REQUIRE(!text.empty());
    write("bad.toml", text);
    const Outcome outcome = compare("bad.toml --out result");
    CAPTURE(outcome.err);
    CHECK(outcome.status == 2);
    CHECK(outcome.err.starts_with("taut-compare: bad.toml:" + std::to_string(mistake.line) + ":"));
    for (const std::string& part : mistake.says) CHECK(outcome.err.find(part) != std::string::npos);
    CHECK(!fs::exists(folder() / "result"));
  }
}

TEST_CASE("a reference or a cloud with what is no number is refused with its file and line") {
  write("nan.csv", "nu,ux\n0.3,nan\n");
  std::string text = taut::test::good_scene + "[sweep]\nnu = 0.3\n";
  const std::string at = "at = [0.2, 0.025]";
  text.replace(text.find(at), at.size(),
               at + "\nreference = { file = \"nan.csv\", column = \"ux\", keys = { nu = \"nu\" } }");
  write("bad.toml", text);
  Outcome outcome = compare("bad.toml --out result");
  CHECK(outcome.status == 2);
  CAPTURE(outcome.err);
  CHECK(outcome.err.find("nan.csv:2: column ux: 'nan' is not a finite number") != std::string::npos);

  write("cloud.csv", "x,y\n0,0\n0.1,nan\n");
  text = taut::test::good_scene;
  const std::string box = "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]\n\n[lattice]\ndx = 0.0125";
  text.replace(text.find(box), box.size(), "type = \"csv\"\nfile = \"cloud.csv\"");
  write("bad.toml", text);
  outcome = compare("bad.toml --out result");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("cloud.csv:3:") != std::string::npos);
  CHECK(!fs::exists(folder() / "result"));
}

TEST_CASE("bad options and missing files are bad input too") {
  CHECK(compare("").status == 2);
  CHECK(compare("nowhere.toml").err.find("nowhere.toml: cannot open") != std::string::npos);
  CHECK(compare("nowhere.toml").status == 2);
  CHECK(compare("nowhere.toml --threads 0").status == 2);
  CHECK(compare("--wrong").status == 2);
  CHECK(compare("--help").status == 0);
  CHECK(compare("--version").out.starts_with("taut-compare "));
}

TEST_CASE("the message for what is not installed names a section of the README that exists") {
  const fs::path root = fs::path(TAUT_SCENES) / "../..";
  const std::string message = read_file(root / "cmake/dependencies.cmake");
  const std::string before = "see README.md, '";
  const std::size_t at = message.find(before);
  REQUIRE(at != std::string::npos);
  const std::size_t begin = at + before.size();
  const std::string section = message.substr(begin, message.find('\'', begin) - begin);
  CHECK(read_file(root / "README.md").find("\n## " + section + '\n') != std::string::npos);
}

TEST_CASE("a run writes everything it promises") {
  write("good.toml", taut::test::good_scene + "\n[[picture]]\ntitle = \"Pulled\"\n");
  const Outcome outcome = compare("good.toml --out result --threads 1");
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK(outcome.out.find("[1/1] small, total: tip_ux = ") != std::string::npos);
  const auto rows = probe_rows(folder() / "result/results.csv");
  REQUIRE(rows.size() == 2);
  CHECK(
      rows[1].starts_with("small,tl_displacement,corrected,st_venant_kirchhoff,wendland_c2,1.5,0.0125,85,"));
  CHECK(rows[1].find(",tip_ux,0.001") !=
        std::string::npos);  // 1000 N / (E H) L = 2 mm, less the clamp's constraint
  CHECK(rows[1].find(",m,ok,") != std::string::npos);
  const auto all = lines_of(folder() / "result/results.csv");
  CHECK(all[1] == rows[1]);  // health comes behind the probes
  CHECK(std::any_of(all.begin(), all.end(), [](const std::string& line) {
    return line.find(",health_roughness,") != std::string::npos && line.find(",1,ok,") != std::string::npos;
  }));
  const std::string report = read_file(folder() / "result/report.html");
  CHECK(report.starts_with("<!doctype html>"));
  CHECK(report.find("tip_ux") != std::string::npos);
  CHECK(report.find("Health: can these runs be trusted?") != std::string::npos);
  // Self-contained: nothing is loaded from elsewhere.
  CHECK(report.find("http") == std::string::npos);
  CHECK(report.find("src=\"/") == std::string::npos);
  if (taut::has_field_output()) CHECK(fs::file_size(folder() / "result/fields/small_total.vtkhdf") > 1000);
  for (const auto& entry : fs::recursive_directory_iterator(folder() / "result"))
    CHECK(entry.path().extension() != ".tmp");
}

TEST_CASE("charts and pictures are drawn where gnuplot is installed") {
  if (std::system("gnuplot --version >/dev/null 2>&1") != 0) return;
  write("drawn.toml", taut::test::good_scene + R"(
[[run]]
label = "cells"
formulation = "tl_displacement"
lattice = "cell_centred"

[[probe]]
name = "tip_ux_known"
type = "displacement"
axis = "x"
at = [0.2, 0.025]
reference = 0.002

[sweep]
load = [500, 1000]
dx = [0.0125, 0.025]

[[picture]]
title = "Pulled"
)");
  const Outcome outcome = compare("drawn.toml --out drawn --no-fields");
  REQUIRE(outcome.status == 0);
  CHECK(outcome.err == "");
  for (const char* chart : {"small_tip_ux", "small_tip_ux_known", "small_tip_ux_known_error",
                            "small_tip_ux_known_dx_load_1000_n", "small_cost"}) {
    CAPTURE(chart);
    CHECK(read_file(folder() / "drawn/charts" / (std::string(chart) + ".svg")).find("</svg>") !=
          std::string::npos);
  }
  CHECK(fs::file_size(folder() / "drawn/pictures/small.png") > 1000);
  CHECK(read_file(folder() / "drawn/report.html").find("data:image/svg+xml;base64,") != std::string::npos);
}

TEST_CASE("without gnuplot the numbers are there, and a note") {
  write("sweep.toml",
        taut::test::good_scene + "[sweep]\nload = [500, 1000]\n[[picture]]\ntitle = \"Pulled\"\n");
  const Outcome outcome = compare("sweep.toml --out bare --no-fields", "TAUT_GNUPLOT=");
  REQUIRE(outcome.status == 0);
  CHECK(outcome.out.find("gnuplot was not found") != std::string::npos);
  CHECK(read_file(folder() / "bare/report.html").find("gnuplot was not found") != std::string::npos);
  CHECK(fs::exists(folder() / "bare/charts/small_tip_ux.csv"));
  CHECK(!fs::exists(folder() / "bare/fields"));
}

TEST_CASE("a formulation that breaks is a result, and the others still run") {
  std::string text = taut::test::good_scene + R"(
[[run]]
label = "breaks"
formulation = "ul_basic"
kernel = "sinc5"
support_dx = 2.4
lattice = "cell_centred"
dx = 0.005
material = "hypoelastic"

[[run]]
label = "after it"
formulation = "tl_displacement"
)";
  text.replace(text.find("force = 1000.0"), 14, "force = 7000.0");
  write("breaks.toml", text);
  const Outcome outcome = compare("breaks.toml --out broken --no-fields");
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  const auto rows = probe_rows(folder() / "broken/results.csv");
  REQUIRE(rows.size() == 5);
  CHECK(rows[1].find(",ok,") != std::string::npos);
  CHECK(rows[2].find(",tip_ux,,,,m,broke,") != std::string::npos);  // a time is no displacement
  CHECK(rows[3].find(",breakdown_time,") != std::string::npos);
  CHECK(rows[3].find(",s,ok,") != std::string::npos);
  CHECK(rows[3].ends_with(",breaks"));
  CHECK(rows[4].find(",ok,") != std::string::npos);
  CHECK(outcome.out.find("breaks: BROKE at t = ") != std::string::npos);
  CHECK(outcome.out.find("particle") != std::string::npos);
  const std::string report = read_file(folder() / "broken/report.html");
  CHECK(report.find("Which broke, and when") != std::string::npos);
}

TEST_CASE("a run that is not to be trusted is suspect, and says why") {
  std::string text = taut::test::good_scene;
  // One cell across.
  text.replace(text.find("max = [0.2, 0.05]"), 17, "max = [0.2, 0.0125]");
  text.replace(text.find("at = [0.2, 0.025]"), 17, "at = [0.2, 0.0125]");
  text.replace(text.find("force = 1000.0"), 14, "force = 0.01");
  text.replace(text.find("direction = [1.0, 0.0]"), 22, "direction = [0.0, 1.0]");
  write("suspect.toml", text);
  const Outcome outcome = compare("suspect.toml --out suspect --no-fields");
  CAPTURE(outcome.err);
  REQUIRE(outcome.status == 0);
  CHECK(outcome.out.find("SUSPECT: health_roughness") != std::string::npos);
  const auto rows = probe_rows(folder() / "suspect/results.csv");
  REQUIRE(rows.size() == 2);
  CHECK(rows[1].find(",m,suspect,") != std::string::npos);
  CHECK(read_file(folder() / "suspect/report.html").find("1 of 1 suspect") != std::string::npos);
}

TEST_CASE("an output folder that cannot be made fails the run") {
  write("good.toml", taut::test::good_scene);
  write("a_file", "x");
  const Outcome outcome = compare("good.toml --out a_file/below");
  CHECK(outcome.status == 1);
  CHECK(outcome.err.find("a_file") != std::string::npos);
}
