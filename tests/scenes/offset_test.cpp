// Scenes at map coordinates, in metres and in millimetres, against the same scene at the origin.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <lib/case.hpp>
#include <lib/scene_loader.hpp>

using namespace taut;
using namespace taut::bench;

namespace {

// A bar of 0.2 x 0.05 with a stiffer end, stretched, pulled and prescribed; all lengths times `unit`.
std::string scene(double x, double y, double unit, const char* left) {
  const auto point = [&](double dx, double dy) {
    // As decimals: what the file says, not what doubles make of it.
    return fmt::format("[{:.6f}, {:.6f}]", x + dx * unit, y + dy * unit);
  };
  return fmt::format(R"(
scene = {{ name = "there", dimension = 2 }}
geometry = {{ type = "box", min = {}, max = {} }}
lattice = {{ dx = {} }}
material = {{ model = "linear_elastic", E = 2e6, nu = 0.3, density = 1000.0, plane = "stress" }}
region = [{{ where = {{ x = [{:.6f}, {:.6f}] }}, model = "linear_elastic", E = 4e6, nu = 0.3, density = 1000.0, plane = "stress" }}]
boundary = [{{ type = "{}", on = "x_min"{} }}, {{ type = "symmetry", on = "y_max" }}, {{ type = "load", on = "x_max", force = {}, direction = [1.0, 0.0] }}]
initial = [{{ stretch = [1.001, 1.0] }}]
solve = {{ mode = "dynamic", duration = {}, samples = 10 }}
probe = [{{ name = "tip", type = "displacement", axis = "x", at = {} }},
         {{ name = "inside", type = "displacement", axis = "x", at = {} }},
         {{ name = "stress", type = "cauchy_stress", component = "xx", at = {} }}]
run = [{{ label = "pairs", formulation = "tl_displacement" }}, {{ label = "cells", formulation = "tl_stress_points" }},
       {{ label = "centred", formulation = "tl_displacement", lattice = "cell_centred" }}]
)",
                     point(0, 0), point(0.2, 0.05), 0.005 * unit, x + 0.15 * unit, x + 0.2 * unit, left,
                     left == std::string("roller") ? ", axis = \"x\"" : ", layers = 2", 100 * unit,
                     0.01 * unit, point(0.2, 0.025), point(0.113, 0.021), point(0.1, 0.025));
}

std::vector<double> values(const std::string& text) {
  const Scene scene = parse_scene(text, "there.toml");
  std::vector<double> all;
  for (const RunSpec& run : scene.runs) {
    const CaseResult result = run_case(scene, run, {}, {});
    CHECK(!result.broke);
    for (const Measured& m : result.measured) all.push_back(m.value.value_or(0));
  }
  return all;
}

}  // namespace

TEST_CASE("a scene has the same results at map coordinates as at the origin") {
  for (const char* left : {"roller", "clamp"})
    for (const double unit : {1.0, 1000.0}) {
      CAPTURE(left);
      CAPTURE(unit);
      const auto here = values(scene(0, 0, unit, left)),
                 there = values(scene(5e5 * unit, 5.4e6 * unit, unit, left));
      REQUIRE(here.size() == 9);
      REQUIRE(there.size() == 9);
      for (std::size_t i = 0; i < here.size(); ++i) {
        CAPTURE(i);
        CHECK(here[i] != 0);
        CHECK(std::abs(there[i] - here[i]) <= 1e-9 * std::abs(here[i]));
      }
    }
}
