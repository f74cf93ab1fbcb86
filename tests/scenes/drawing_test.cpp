// Charts and pictures: what a reader looks at.
#include <doctest/doctest.h>

#include <cmath>
#include <lib/chart.hpp>
#include <lib/files.hpp>
#include <lib/scene_loader.hpp>
#include <lib/view.hpp>
#include <program.hpp>
#include <regex>
#include <scenes/malformed.hpp>
#include <taut/base/error.hpp>

using namespace taut::bench;

namespace {

/// The script that draws a chart.
std::string script_of(const Chart& chart) {
  const auto folder = taut::test::fresh_folder("drawing");
  std::filesystem::create_directories(folder / "charts");
  std::string why;
  write_chart(chart, folder / "charts", why);
  const std::string text = read_file(folder / "charts" / (chart.name + ".svg.gp"));
  std::filesystem::remove_all(folder);
  return text;
}

Chart chart_with(std::vector<Series> series) {
  Chart chart{"many", "Many", "", "x", "y"};
  chart.series = std::move(series);
  return chart;
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t found = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++found;
  return found;
}

/// Of a solid scene with one picture that has this view.
std::array<double, 3> view_in_scene(const std::string& view) {
  return parse_scene(
             "[scene]\nname = \"s\"\ndimension = 3\n[geometry]\ntype = \"box\"\nmin = [0.0, 0.0, 0.0]\nmax = "
             "[1.0, "
             "1.0, 1.0]\n[lattice]\ndx = 0.5\n[material]\nmodel = \"neo_hookean\"\nE = 1.0\nnu = "
             "0.3\ndensity = "
             "1.0\n[solve]\nmode = \"relax\"\n[[probe]]\nname = \"e\"\ntype = "
             "\"kinetic_energy\"\n[[run]]\nlabel = "
             "\"r\"\nformulation = \"tl_displacement\"\n[[picture]]\ntitle = \"p\"\n" +
                 view,
             "s.toml")
      .pictures[0]
      .from;
}

std::string view_error(const std::string& view) {
  try {
    view_in_scene(view);
  } catch (const taut::InputError& error) {
    return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("legends of many runs are lower than their plots, and count what they leave out") {
  std::vector<Series> series;
  for (int i = 0; i < 60; ++i)
    series.push_back({"a label that is as long as labels of runs are, number " + std::to_string(i),
                      Series::Style::run,
                      i,
                      {0, 1},
                      {0, 1},
                      {},
                      true});
  const std::string script = script_of(chart_with(series));
  std::smatch rows;
  REQUIRE(std::regex_search(script, rows, std::regex("set key maxrows (\\d+)")));
  CHECK(std::stoi(rows[1]) <= 12);
  const std::size_t listed = count(script, " title '") - 1;  // "set title" is one
  CHECK(listed <= 24);
  CHECK(script.find("and " + std::to_string(60 - (listed - 1)) + " more, in many.csv") != std::string::npos);
  CHECK(script.find("number 0'") != std::string::npos);  // cut in its middle, where they are alike

  series.resize(5);
  CHECK(count(script_of(chart_with(series)), " title '") == 6);
}

TEST_CASE("a label has its colour wherever it is asked for") {
  const int first = colour_of("drawing test, first"), second = colour_of("drawing test, second");
  CHECK(first != second);
  CHECK(colour_of("drawing test, first") == first);
}

TEST_CASE("a run that broke is marked, and does not hide the others") {
  Series sound{"sound", Series::Style::run, 0, {0, 1, 2}, {0, 1, 0.5}, {}, false};
  Series broken{"broken", Series::Style::run, 1, {0, 1}, {0, 1e30}, {1}, false};
  broken.wild = true;
  const std::string script = script_of(chart_with({sound, broken}));
  std::smatch range;
  REQUIRE(std::regex_search(script, range, std::regex("set yrange \\[([^:]*):([^\\]]*)\\]")));
  CHECK(std::stod(range[2]) > 1);
  CHECK(std::stod(range[2]) < 4);
  CHECK(script.find("pt 2") != std::string::npos);  // the cross
  // Alone, it is seen as it is.
  const std::string alone = script_of(chart_with({broken}));
  REQUIRE(std::regex_search(alone, range, std::regex("set yrange \\[([^:]*):([^\\]]*)\\]")));
  CHECK(std::stod(range[2]) > 1e30);
}

TEST_CASE("views of solid bodies") {
  const View corner({1, -2, 1});
  CHECK(!corner.is_straight());
  CHECK(std::abs(corner.project({0, 0, 1})[0]) < 1e-12);
  CHECK(corner.project({0, 0, 1})[1] > 0.5);
  CHECK(corner.project({1, 0, 0})[0] > 0.5);
  CHECK(corner.project({1, -2, 1})[2] == doctest::Approx(std::sqrt(6.0)));
  // The faces that are seen differ in brightness; what is turned away is darkest.
  CHECK(corner.brightness({0, 0, 1}) > corner.brightness({0, -1, 0}));
  CHECK(corner.brightness({0, -1, 0}) > corner.brightness({1, 0, 0}));
  CHECK(corner.brightness({0, 1, 0}) == corner.brightness({0, 0, -1}));

  const auto axes = [](const char* name) {
    const View view(view_in_scene(std::string("view = \"") + name + '"'));
    return std::pair(view.right_axis(), view.up_axis());
  };
  CHECK(axes("along_x") == std::pair(1, 2));
  CHECK(axes("along_y") == std::pair(0, 2));
  CHECK(axes("along_z") == std::pair(0, 1));
  CHECK(view_in_scene("") == view_in_scene("view = \"corner\""));
  CHECK(!View(view_in_scene("")).is_straight());
  CHECK(view_in_scene("view = [0.0, 0.0, 2.0]") == std::array<double, 3>{0, 0, 1});
  CHECK(view_error("view = [0.0, 0.0, 0.0]").find(":1: [picture] view: the direction") != std::string::npos);
  CHECK(view_error("view = \"top\"").find("valid: corner, along_x") != std::string::npos);
  CHECK(view_error("view = [1.0, 2.0]") != "");
}

TEST_CASE("outward directions of particles, clumped ones and strays too") {
  std::vector<Point> x;
  for (int i = 0; i < 1000; ++i) x.push_back({0.1 * (i % 10), 0.1 * (i / 10 % 10), 0.1 * (i / 100)});
  std::vector<Point> n = outward(x, 0.1);
  const auto length = [](const Point& p) { return std::hypot(p[0], p[1], p[2]); };
  CHECK(length(n[555]) < 1e-9);
  CHECK(n[955][2] > 0.3);  // the middle of the upper face
  CHECK(std::abs(n[955][0]) < 1e-9);
  CHECK(n[0][0] < -0.1);
  x.insert(x.end(), 5000, Point{0, 0, 0});
  x.push_back({1e300, -1e300, 0});
  n = outward(x, 0.1);
  CHECK(length(n.back()) == 0);
}
