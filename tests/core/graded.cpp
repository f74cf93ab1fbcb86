// Supports that grow with the spacing of a cloud.

#include <doctest/doctest.h>

#include <taut/taut.hpp>

using namespace taut;

namespace {

/// Rows of nodes across a strip 0.2 x 0.02, whose spacing grows from 1.25 to 5 mm along it, with their
/// volumes.
Cloud<2> graded_strip() {
  std::vector<double> x{0};
  while (x.back() < 0.2) x.push_back(x.back() + 0.00125 * (1 + 3 * x.back() / 0.2));
  const double scale = 0.2 / x.back();
  for (double& at : x) at *= scale;
  Cloud<2> cloud;
  cloud.dx = 0.0028;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double width = (x[std::min(i + 1, x.size() - 1)] - x[i > 0 ? i - 1 : 0]) / 2;
    const int rows = static_cast<int>(std::lround(0.02 / (0.00125 * (1 + 3 * x[i] / 0.2))));
    for (int j = 0; j <= rows; ++j) {
      cloud.X.emplace_back(x[i], 0.02 * j / rows);
      cloud.V.push_back(width * 0.02 / rows * (j == 0 || j == rows ? 0.5 : 1));
    }
  }
  grade_spacing(cloud);
  return cloud;
}

}  // namespace

TEST_CASE("clouds are graded where spacings differ, not where they are jittered") {
  const Cloud<2> strip = graded_strip();
  REQUIRE(strip.spacing.size() == strip.size());
  CHECK(strip.spacing.front() < 0.0016);
  CHECK(strip.spacing.back() > 0.0045);
  Cloud<2> jittered = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 0.05, .jitter = 0.4});
  grade_spacing(jittered);
  CHECK(jittered.spacing.empty());
}

TEST_CASE("a graded cantilever bends as finite elements do") {
  Simulation<2> beam(graded_strip(),
                     make_material<2>("st_venant_kirchhoff",
                                      {.E = 20e6, .nu = 0.3, .density = 1000, .plane = Plane::stress}),
                     {.operators = "compatible", .kernel = "quadratic"});
  beam.clamp(beam.face("x_min"));
  beam.load(beam.face("x_max"), {0, -10});
  CHECK(beam.relax({.tolerance = 1e-4, .max_steps = 100000}).status == Status::ok);
  CHECK(beam.displacement_at({0.2, 0.01}).y() == doctest::Approx(-2.0117e-3).epsilon(0.01));
}
