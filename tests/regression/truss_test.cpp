// Truss under axial dead loads (Tran-Duc et al. 2023, 3.2): truth by total Lagrangian Q2 finite elements, 40
// x 10, St. Venant-Kirchhoff, plane stress; mid-height end displacement in mm (bench/reference/truss.csv).
#include <doctest/doctest.h>

#include <cmath>
#include <taut/materials/hypoelastic_bar.hpp>

#include "bodies.hpp"

using namespace taut;

namespace {
struct Truth {
  double load, nu, ux_mm;
};
constexpr Truth truths[] = {
    {1000, 0, 1.9708},     {3000, 0, 5.7497},     {5000, 0, 9.3361},      {7000, 0, 12.7541},
    {-1000, 0, -2.0308},   {-3000, 0, -6.2940},   {-5000, 0, -10.8701},   {-7000, 0, -15.8298},
    {1000, 0.3, 1.9646},   {3000, 0.3, 5.7312},   {5000, 0.3, 9.3055},    {7000, 0.3, 12.7114},
    {-1000, 0.3, -2.0246}, {-3000, 0.3, -6.2753}, {-5000, 0.3, -10.8391}, {-7000, 0.3, -15.7867}};
}  // namespace

TEST_CASE("truss: tl_displacement is within 1 % of finite elements at every load") {
  for (const Truth& truth : truths) {
    CAPTURE(truth.load);
    CAPTURE(truth.nu);
    const auto outcome = solve({.load = truth.load, .nu = truth.nu});
    CHECK(outcome.result.status == Status::ok);
    CHECK(1e3 * outcome.tip.x() == doctest::Approx(truth.ux_mm).epsilon(0.01));
    CHECK(std::abs(outcome.tip.y()) < 1e-8);  // symmetric about mid-height
  }
}

TEST_CASE(
    "truss: tl_displacement has the uniform state exactly, and its error falls with the spacing where there "
    "is one") {
  for (const Truth& truth : {truths[3], truths[7], truths[11], truths[15]}) {
    CAPTURE(truth.load);
    CAPTURE(truth.nu);
    const double coarse = 1e3 * solve({.load = truth.load, .nu = truth.nu}).tip.x() / truth.ux_mm - 1;
    const double fine =
        1e3 * solve({.load = truth.load, .nu = truth.nu, .dx = 1e-3}).tip.x() / truth.ux_mm - 1;
    if (truth.nu == 0) {
      // Left are the last digit of the reference, 4e-6, and what relaxation leaves.
      CHECK(std::abs(coarse) < 2e-5);
      CHECK(std::abs(fine) < 2e-5);
    } else {
      CHECK(std::abs(fine) < 0.7 * std::abs(coarse));
    }
  }
}

TEST_CASE("truss: ul_basic tears in tension and follows its own law in compression") {
  // Tran-Duc et al. damp by viscosity; without it the bodies chatter.
  Method method = updated_lagrangian("ul_basic");
  method.viscosity = 1;
  for (const double load : {3000.0, 5000.0, 7000.0}) {
    CAPTURE(load);
    const auto outcome = solve({.load = load,
                                .material = "hypoelastic",
                                .lattice = Lattice::cell_centred,
                                .method = method,
                                .solve = {.ramp_time = 0.03, .max_steps = 20000}});
    REQUIRE(outcome.result.status == Status::broke);
    CHECK(outcome.result.breakdown->what == "lost neighbours");
    CHECK(outcome.result.breakdown->time > 0);
    CHECK(outcome.result.breakdown->particle >= 0);
  }
  for (const double load : {-1000.0, -3000.0, -5000.0, -7000.0}) {
    CAPTURE(load);
    const auto outcome = solve({.load = load,
                                .material = "hypoelastic",
                                .lattice = Lattice::cell_centred,
                                .method = method,
                                .solve = {.ramp_time = 0.03, .max_steps = 20000}});
    CHECK(outcome.result.status == Status::ok);
    const MaterialParameters bar{.E = 2e6, .nu = 0, .density = 1000, .plane = Plane::stress};
    const double exact = 0.2 * (hypoelastic_bar(bar, BarSides::free, load / 0.05).value().stretch - 1);
    CHECK(outcome.tip.x() == doctest::Approx(exact).epsilon(0.05));
  }
}

TEST_CASE("truss: ul_artificial_stress holds 3000 N but is softer than the truth") {
  Method method = updated_lagrangian("ul_artificial_stress");
  method.viscosity = 1;
  const auto outcome = solve({.load = 3000,
                              .material = "hypoelastic",
                              .lattice = Lattice::cell_centred,
                              .method = method,
                              .solve = {.ramp_time = 0.03, .max_steps = 20000}});
  CHECK(outcome.result.status == Status::ok);
  CHECK(1e3 * outcome.tip.x() > 1.1 * 5.7497);
}

TEST_CASE("truss: the discretisation of Tran-Duc et al. gives their displacements") {
  // Their table 3 at dx = 2 mm for P = R S: 5.82 and 13.45 mm. Where the load acts and what is held are not
  // printed.
  Method method = updated_lagrangian("tl_displacement");
  for (const auto& [load, printed] : {std::pair{3000.0, 5.82}, std::pair{7000.0, 13.45}}) {
    const auto outcome = solve(
        {.load = load, .material = "corotated_svk", .lattice = Lattice::cell_centred, .method = method});
    CHECK(outcome.result.status == Status::ok);
    CHECK(1e3 * outcome.tip.x() == doctest::Approx(printed).epsilon(0.03));
  }
}
