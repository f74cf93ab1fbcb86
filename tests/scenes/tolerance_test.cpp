// taut-compare --tolerance: its numbers, its choice, its job.

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <lib/candidates.hpp>
#include <lib/extrapolation.hpp>
#include <lib/files.hpp>
#include <lib/results.hpp>
#include <lib/scene_loader.hpp>
#include <lib/tolerance.hpp>
#include <program.hpp>
#include <scenes/malformed.hpp>

using namespace taut;
using namespace taut::bench;

namespace {

namespace fs = std::filesystem;

/// A folder for one test, gone when it ends.
struct Folder {
  fs::path path;
  explicit Folder(const std::string& name) : path(test::fresh_folder("tolerance-" + name)) {}
  ~Folder() { fs::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  void write(const std::string& name, const std::string& text) const { std::ofstream(path / name) << text; }
  test::Outcome compare(const std::string& arguments) const {
    return test::run_program(TAUT_COMPARE, arguments, path);
  }
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

/// Small pull of a bar that is free to contract: uniform stress, u = F L / (E H) = 0.1 mm but for St. Venant
/// and Kirchhoff's quadratic term, which is 0.15 % of it.
std::string pull() {
  std::string text =
      replaced(test::good_scene, "type = \"clamp\"\non = \"x_min\"",
               "type = \"roller\"\non = \"x_min\"\n[[boundary]]\ntype = \"roller\"\non = \"y_min\"");
  text = replaced(text, "force = 1000.0", "force = 50.0");
  return replaced(text, "at = [0.2, 0.025]", "at = [0.2, 0.025]\nreference = 1e-4");
}

Sample sample(double dx, double error, double loop_s, std::int64_t steps, std::int64_t pairs) {
  Sample s;
  s.dx = dx;
  s.error = error;
  CaseResult c;
  c.loop_s = loop_s;
  c.steps = steps;
  c.pairs = pairs;
  s.cases.push_back(c);
  return s;
}

/// A 2D candidate with error C dx^order at 8 and 4 mm.
Candidate with_order(double order, double at_4mm, double loop_s) {
  Candidate c;
  c.samples.push_back(sample(8e-3, at_4mm * std::pow(2, order), loop_s / 8, 100, 1000));
  c.samples.push_back(sample(4e-3, at_4mm, loop_s, 200, 4000));
  return c;
}

}  // namespace

TEST_CASE("Richardson extrapolation finds the limit and the order of a power law") {
  for (const double p : {0.7, 1.0, 2.0, 3.5})
    for (const double fine : {1.0, 1.5}) {
      const std::array<double, 3> h = {4, 2, fine};
      std::array<double, 3> f{};
      for (std::size_t k = 0; k < 3; ++k) f[k] = -3 + 0.2 * std::pow(h[k], p);
      const Extrapolated e = richardson(h, f);
      REQUIRE(e.ok);
      CHECK(e.order == doctest::Approx(p).epsilon(1e-9));
      CHECK(e.limit == doctest::Approx(-3).epsilon(1e-9));
    }
}

TEST_CASE("Richardson extrapolation refuses values that are on no such curve") {
  CHECK(richardson({4, 2, 1}, {1, 2, 1.5}).why_not.find("not monotone") != std::string::npos);
  CHECK(!richardson({4, 2, 1}, {1, 1, 1}).ok);
  CHECK(!richardson({4, 2, 1}, {1, std::nan(""), 1}).ok);
  CHECK(richardson({4, 2, 1}, {3, 2, 1}).why_not.find("below 0.5") != std::string::npos);
  CHECK(richardson({4, 2, 1}, {100, 1, 0.99}).why_not.find("above 4") != std::string::npos);
}

TEST_CASE("a prediction follows the power law, and its cost the pairs and steps") {
  Candidate c = with_order(2, 0.04, 1);
  predict(c, 0.0125, 0.08, 1e-6, 2);  // aim 0.01: half of 4 mm
  REQUIRE(c.prediction);
  CHECK(c.prediction->dx == doctest::Approx(2e-3));
  CHECK(c.prediction->error == doctest::Approx(0.01));
  CHECK(*c.prediction->order == doctest::Approx(2));
  CHECK(c.prediction->seconds == doctest::Approx(8));  // 4 times the pairs, twice the steps

  Candidate steep = with_order(4, 0.04, 1);  // no better than second order is trusted beyond the pilots
  predict(steep, 0.0125, 0.08, 1e-6, 2);
  CHECK(steep.prediction->dx == doctest::Approx(2e-3));

  Candidate good = with_order(2, 0.001, 1);
  predict(good, 0.01, 0.08, 1e-6, 2);  // the coarsest is good enough, and nothing coarser is promised
  CHECK(good.prediction->dx == 8e-3);

  Candidate between = with_order(2, 0.005, 1);
  predict(between, 0.01, 0.08, 1e-6, 2);
  CHECK(between.prediction->dx > 4e-3);
  CHECK(between.prediction->dx < 8e-3);
  CHECK(between.prediction->error <= 0.008 * (1 + 1e-9));
}

TEST_CASE("candidates that do not converge, or out of reach, are out, and say why") {
  Candidate stuck = with_order(0, 0.6, 1);
  predict(stuck, 0.01, 0.08, 1e-6, 2);
  CHECK(stuck.out.find("does not converge") != std::string::npos);
  Candidate far = with_order(1, 0.1, 1);
  predict(far, 0.001, 0.08, 1e-3, 2);
  CHECK(far.out.find("finer than") != std::string::npos);

  std::vector<Candidate> all = {stuck, with_order(2, 0.04, 3), with_order(2, 0.04, 1)};
  for (Candidate& c : all) predict(c, 0.0125, 0.08, 1e-6, 2);
  CHECK(cheapest(all) == &all[2]);
  for (Candidate& c : all) c.out = "out";
  CHECK(cheapest(all) == nullptr);
}

TEST_CASE("the scene's runs are candidates, once each") {
  const Scene scene = parse_scene(test::good_scene, "good.toml");
  std::vector<std::string> left_out;
  const auto all = candidates_of(scene, true, left_out);
  CHECK(left_out.empty());
  CHECK(all.front().run.label == "total");
  CHECK(all.size() == 7);
  CHECK(std::count_if(all.begin(), all.end(), [](const Candidate& c) {
          const Method& m = c.run.method;
          return m.formulation == "tl_displacement" && m.operators == "corrected" &&
                 m.kernel == "wendland_c2";
        }) == 1);

  const Scene other = parse_scene(test::good_scene + "material = \"neo_hookean\"\n", "other.toml");
  CHECK(candidates_of(other, true, left_out).size() == 8);
  CHECK(left_out.empty());
  CHECK(candidates_of(other, false, left_out).size() == 7);  // nothing tells which material is right
  CHECK(left_out.size() == 1);
}

TEST_CASE("tolerances are numbers or percentages") {
  CHECK(parse_tolerance("1%") == doctest::Approx(0.01));
  CHECK(parse_tolerance("0.01") == 0.01);
  CHECK(parse_tolerance("0.25%") == doctest::Approx(0.0025));
  for (const char* bad :
       {"0", "0%", "abc", "", "%", "-1%", "1", "100%", "1%%", "nan", "inf", "0.01x", "1 %"}) {
    CAPTURE(bad);
    CHECK_THROWS_WITH_AS(parse_tolerance(bad), doctest::Contains("valid: 1%, 0.5%, 0.01"), InputError);
  }
}

TEST_CASE("--tolerance ends bad input with exit code 2 and no files") {
  const Folder folder("bad");
  folder.write("good.toml", test::good_scene);
  for (const char* bad : {"0", "abc"}) {
    const test::Outcome outcome = folder.compare(std::string("good.toml --out result --tolerance ") + bad);
    CHECK(outcome.status == 2);
    CHECK(outcome.err.find("valid: 1%, 0.5%, 0.01") != std::string::npos);
    CHECK(!fs::exists(folder.path / "result"));
  }
  CHECK(folder.compare("--help").out.find("--tolerance") != std::string::npos);
}

TEST_CASE("--tolerance finds, verifies and reports a method for a body with a reference") {
  const Folder folder("known");
  folder.write("pull.toml", pull());
  const test::Outcome outcome = folder.compare("pull.toml --out result --tolerance 1% --threads 1");
  CAPTURE(outcome.err);
  CAPTURE(outcome.out);
  REQUIRE(outcome.status == 0);
  CHECK(outcome.out.find("the cheapest that meets 1 % is ") != std::string::npos);
  const std::vector<Row> rows = read_results(folder.path / "result/results.csv");
  CHECK(std::count_if(rows.begin(), rows.end(), [](const Row& r) { return r.quantity == "pilot_tip_ux"; }) ==
        14);
  const auto chosen =
      std::find_if(rows.begin(), rows.end(), [](const Row& r) { return r.quantity == "chosen_tip_ux"; });
  REQUIRE(chosen != rows.end());
  REQUIRE(chosen->error);
  CHECK(std::abs(*chosen->error) <= 0.01);
  CHECK(chosen->reference == 1e-4);
  const std::string report = read_file(folder.path / "result/report.html");
  CHECK(report.find("the cheapest that meets 1 % is ") != std::string::npos);
  CHECK(report.find("chosen") != std::string::npos);
  CHECK(fs::exists(folder.path / "result/charts/small_tolerance.csv"));
}

TEST_CASE("--tolerance extrapolates where there is no reference") {
  const Folder folder("unknown");
  folder.write("good.toml", test::good_scene);
  const test::Outcome outcome = folder.compare("good.toml --out result --tolerance 5% --threads 1");
  CAPTURE(outcome.err);
  CAPTURE(outcome.out);
  REQUIRE(outcome.status == 0);
  CHECK(outcome.out.find("Richardson") != std::string::npos);
  const std::vector<Row> rows = read_results(folder.path / "result/results.csv");
  const auto chosen =
      std::find_if(rows.begin(), rows.end(), [](const Row& r) { return r.quantity == "chosen_tip_ux"; });
  REQUIRE(chosen != rows.end());
  REQUIRE(chosen->error);
  CHECK(std::abs(*chosen->error) <= 0.05);
}

TEST_CASE("--tolerance that nothing meets ends with exit code 1 and the nearest") {
  const Folder folder("missed");
  folder.write("pull.toml", replaced(pull(), "reference = 1e-4", "reference = 2e-4"));
  const test::Outcome outcome = folder.compare("pull.toml --out result --tolerance 0.01 --threads 1");
  CAPTURE(outcome.out);
  CHECK(outcome.status == 1);
  CHECK(outcome.err.find("no candidate meets 1 %; nearest: ") != std::string::npos);
  CHECK(outcome.err.find("error 5") != std::string::npos);  // half the reference
  CHECK(fs::exists(folder.path / "result/report.html"));
  const std::vector<Row> rows = read_results(folder.path / "result/results.csv");
  CHECK(
      std::none_of(rows.begin(), rows.end(), [](const Row& r) { return r.quantity.starts_with("chosen_"); }));
}

TEST_CASE("--tolerance refuses a cloud from a file without references") {
  const Folder folder("cloud");
  std::string cloud = "x,y\n";
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 2; ++j) cloud += std::to_string(i * 0.025) + ',' + std::to_string(j * 0.025) + '\n';
  folder.write("cloud.csv", cloud);
  folder.write("cloud.toml",
               replaced(test::good_scene,
                        "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]\n\n[lattice]\ndx = 0.0125",
                        "type = \"csv\"\nfile = \"cloud.csv\""));
  const test::Outcome outcome = folder.compare("cloud.toml --out result --tolerance 1%");
  CAPTURE(outcome.err);
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("has one spacing") != std::string::npos);
  CHECK(!fs::exists(folder.path / "result"));
}
