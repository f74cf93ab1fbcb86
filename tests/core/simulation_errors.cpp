// What a simulation refuses, in words that a stranger can act on, and how it reports a body that breaks.
#include <doctest/doctest.h>

#include <core/refusal.hpp>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <taut/taut.hpp>

using namespace taut;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
const MaterialParameters rubber{.E = 1e6, .nu = 0.3, .density = 1000};

Cloud<2> sheet() { return make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1}); }

Simulation<2> simulation(Method method = with_defaults({}), const char* material = "neo_hookean",
                         MaterialParameters parameters = rubber) {
  return {sheet(), make_material<2>(material, parameters), with_defaults(std::move(method))};
}

Where<2> nowhere() {
  return [](const Vec<2>&) { return false; };
}
Where<2> everywhere() {
  return [](const Vec<2>&) { return true; };
}

Method with_formulation(const char* formulation) {
  Method method = with_defaults({});
  method.formulation = formulation;
  return method;
}

}  // namespace

TEST_CASE("simulation errors: unknown names list the valid ones") {
  Method method = with_defaults({});
  method.formulation = "tl_dispalcement";
  CHECK_REFUSED(simulation(method), "unknown formulation \"tl_dispalcement\"", "tl_displacement", "ul_basic",
                "ul_artificial_stress");
  method = {};
  method.operators = "exact";
  CHECK_REFUSED(simulation(method), "unknown operators \"exact\"", "standard", "corrected");
  method = {};
  method.kernel = "cubic";
  CHECK_REFUSED(simulation(method), "unknown kernel \"cubic\"", "cubic_spline", "wendland_c2");
  method = {};
  method.neighbours = "octree";
  CHECK_REFUSED(simulation(method), "\"octree\"", "cell_list", "kd_tree");
  auto s = simulation();
  CHECK_REFUSED(s.face("left"), "\"left\"", "x_min", "y_max");
  CHECK_REFUSED(s.face("z_min"), "\"z_min\"", "x_min", "y_max");
  CHECK_REFUSED(s.run(1, {.integrator = "euler"}), "unknown integrator \"euler\"", "leapfrog",
                "central_difference");
  CHECK_REFUSED(make_material<2>("rubber", rubber), "rubber", "neo_hookean");
}

TEST_CASE("simulation errors: numbers out of range") {
  for (const double support : {1.0, -2.0, 21.0, not_a_number, infinity}) {
    Method method = with_defaults({});
    method.support_dx = support;
    CHECK_REFUSED(simulation(method), "support_dx", "between 1", "20");
  }
  for (const double value : {-1.0, not_a_number, infinity}) {
    Method method = with_defaults({});
    method.zero_energy_control = value;
    CHECK_REFUSED(simulation(method), "zero_energy_control", "negative");
    method = {};
    method.viscosity = value;
    CHECK_REFUSED(simulation(method), "viscosity", "negative");
    method = {};
    method.skin = value;
    CHECK_REFUSED(simulation(method), "skin", "negative");
  }
  auto s = simulation();
  for (const double value : {-1.0, not_a_number, infinity})
    CHECK_REFUSED(s.run(value), "run: the duration", "negative");
  for (const double value : {-1.0, 0.0, not_a_number}) {
    CHECK_REFUSED(s.run(1, {.cfl = value}), "run: cfl", "positive");
    CHECK_REFUSED(s.relax({.cfl = value}), "relax: cfl", "positive");
    CHECK_REFUSED(s.relax({.tolerance = value}), "relax: tolerance", "positive");
  }
}

TEST_CASE("simulation errors: bodies and materials that are none") {
  const std::shared_ptr<const Material<2>> material = make_material<2>("neo_hookean", rubber), none;
  CHECK_REFUSED(Simulation<2>(sheet(), none, with_defaults({})), "needs a material");
  CHECK_REFUSED(Simulation<2>(Cloud<2>{}, material, with_defaults({})), "no particles");
  const auto damaged = [](auto&& damage) {
    Cloud<2> cloud = sheet();
    damage(cloud);
    return cloud;
  };
  for (const double dx : {0.0, -1.0, not_a_number, infinity})
    CHECK_REFUSED(Simulation<2>(damaged([&](auto& c) { c.dx = dx; }), material, with_defaults({})), "spacing",
                  "positive");
  CHECK_REFUSED(Simulation<2>(damaged([](auto& c) { c.V.pop_back(); }), material, with_defaults({})),
                "66 positions", "65 volumes");
  CHECK_REFUSED(Simulation<2>(damaged([](auto& c) { c.B.pop_back(); }), material, with_defaults({})),
                "66 positions", "65 boundary area");
  CHECK_REFUSED(Simulation<2>(damaged([](auto& c) { c.X[5][1] = not_a_number; }), material, with_defaults({}))
                    .prepare(),
                "particle 5", "finite");
  for (const double V : {0.0, -1.0, not_a_number, infinity})
    CHECK_REFUSED(Simulation<2>(damaged([&](auto& c) { c.V[7] = V; }), material, with_defaults({})).prepare(),
                  "particle 7", "volume");
  CHECK_REFUSED(
      Simulation<2>(damaged([](auto& c) { c.X[9] = c.X[8]; }), material, with_defaults({})).prepare(), "8",
      "9", "coincide");

  auto s = simulation();
  CHECK_REFUSED(s.set_material(everywhere(), none), "set_material", "no material");
  for (int k = 0; k < 254; ++k) s.set_material(everywhere(), material);
  CHECK_REFUSED(s.set_material(everywhere(), material), "255 materials");
}

TEST_CASE("simulation errors: conditions on nothing") {
  auto s = simulation();
  const std::shared_ptr<const Material<2>> material = make_material<2>("neo_hookean", rubber);
  CHECK_REFUSED(s.set_material(nowhere(), material), "set_material selects no particle");
  CHECK_REFUSED(s.clamp(nowhere()), "clamp selects no particle");
  CHECK_REFUSED(s.roller(nowhere(), 0), "roller selects no particle");
  CHECK_REFUSED(s.prescribe(nowhere(), 0, [](const Vec<2>&, double) { return 0.0; }),
                "prescribe selects no particle");
  CHECK_REFUSED(s.load(nowhere(), {1, 0}), "load selects no particle");
  for (const int axis : {-1, 2}) {
    CHECK_REFUSED(s.roller(everywhere(), axis), "roller: axis", "0 … 1");
    CHECK_REFUSED(s.prescribe(everywhere(), axis, [](const Vec<2>&, double) { return 0.0; }),
                  "prescribe: axis", "0 … 1");
    CHECK_REFUSED(s.symmetry_plane(axis, 0), "symmetry_plane: axis", "0 … 1");
  }
  CHECK_REFUSED(s.load(everywhere(), {not_a_number, 0}), "load", "finite");
  CHECK_REFUSED(s.body_force({0, infinity}), "body_force", "finite");
  CHECK_REFUSED(s.displacement_at({5, 5}), "no particle within three spacings");
  s.symmetry_plane(0, 0.5);
  CHECK_REFUSED(s.prepare(), "symmetry plane x = 0.5 cuts the body", "particle");
}

TEST_CASE("simulation errors: too late and too early") {
  auto s = simulation();
  CHECK_REFUSED(s.velocity(0), "only after prepare, run or relax");
  CHECK_REFUSED(s.cauchy_stress(0), "only after");
  CHECK_REFUSED(s.first_piola_kirchhoff(0), "only after");
  CHECK_REFUSED(s.deformation_gradient(0), "only after");
  CHECK_REFUSED(s.strain_energy(), "only after");
  CHECK_REFUSED(s.kinetic_energy(), "only after");
  CHECK_REFUSED(s.linear_momentum(), "only after");
  CHECK_REFUSED(s.pairs(), "only after");
  CHECK_REFUSED(s.bytes(), "only after");
  CHECK(s.displacement(0).norm() == 0);

  s.prepare();
  s.prepare();  // twice is no error
  const std::shared_ptr<const Material<2>> material = make_material<2>("neo_hookean", rubber);
  const char* before = "before the first run, relax or prepare";
  CHECK_REFUSED(s.set_material(everywhere(), material), "set_material", before);
  CHECK_REFUSED(s.set_velocity([](const Vec<2>&) { return Vec<2>(0, 0); }), "set_velocity", before);
  CHECK_REFUSED(s.set_displacement([](const Vec<2>&) { return Vec<2>(0, 0); }), "set_displacement", before);
  CHECK_REFUSED(s.clamp(everywhere()), "clamp", before);
  CHECK_REFUSED(s.roller(everywhere(), 0), "roller", before);
  CHECK_REFUSED(s.prescribe(everywhere(), 0, [](const Vec<2>&, double) { return 0.0; }), "prescribe", before);
  CHECK_REFUSED(s.load(everywhere(), {1, 0}), "load", before);
  CHECK_REFUSED(s.body_force({1, 0}), "body_force", before);
  CHECK_REFUSED(s.symmetry_plane(0, 0), "symmetry_plane", before);
}

TEST_CASE("simulation errors: formulations and materials that do not go together") {
  CHECK_REFUSED(simulation({}, "hypoelastic").prepare(), "tl_displacement needs a hyperelastic material",
                "\"hypoelastic\"", "neo_hookean");
  for (const char* name : {"ul_basic", "ul_artificial_stress"}) {
    CHECK_REFUSED(simulation(with_formulation(name)).prepare(), name, "\"neo_hookean\"",
                  "Valid: hypoelastic");
    auto s = simulation(with_formulation(name), "hypoelastic");
    s.prepare();
    CHECK_REFUSED(s.deformation_gradient(0), name, "no deformation gradient");
    CHECK_REFUSED(s.first_piola_kirchhoff(0), name, "no first Piola-Kirchhoff stress");
    CHECK_REFUSED(s.strain_energy(), name, "no stored energy");
    Method method = with_formulation(name);
    method.velocity_gradient = "exact";
    CHECK_REFUSED(simulation(method, "hypoelastic").prepare(), "velocity_gradient \"exact\"",
                  "standard, corrected");
  }
  auto s = simulation({}, "corotated_svk");
  s.prepare();
  CHECK_REFUSED(s.strain_energy(), "corotated_svk", "energy");

  Method method = with_formulation("ul_artificial_stress");
  method.artificial_stress = -0.1;
  CHECK_REFUSED(simulation(method, "hypoelastic").prepare(), "artificial_stress", "negative");
  method = with_formulation("ul_artificial_stress");
  method.artificial_stress_weight = "linear";
  CHECK_REFUSED(simulation(method, "hypoelastic").prepare(), "\"linear\"", "kernel, distance");
  for (const double exponent : {0.0, -1.0, 2.5, 17.0, not_a_number, infinity}) {
    method = with_formulation("ul_artificial_stress");
    method.artificial_stress_exponent = exponent;
    CHECK_REFUSED(simulation(method, "hypoelastic").prepare(), "artificial_stress_exponent",
                  "whole number from 1 to 16");
  }
}

TEST_CASE("simulation errors: particles whose neighbours do not span the space are named") {
  const auto file = std::filesystem::temp_directory_path() / "taut_line_of_particles.csv";
  {
    std::ofstream out(file);
    out << "x,y,volume\n";
    for (int i = 0; i < 9; ++i) out << 0.1 * i << ",0.25,0.01\n";
  }
  const auto cloud = read_cloud<2>(file);
  std::filesystem::remove(file);
  const std::shared_ptr<const Material<2>> material = make_material<2>("neo_hookean", rubber);
  CHECK_REFUSED(Simulation<2>(cloud, material, with_defaults({})).prepare(),
                "correction matrix of particle 0 at (0, 0.25) is singular", "do not span 2 dimension(s)",
                "support_dx");
  // Alone, and far from a body that is sound.
  Cloud<2> lonely = sheet();
  lonely.X.emplace_back(3, 4);
  lonely.V.push_back(0.01);
  lonely.B.emplace_back(0, 0);
  CHECK_REFUSED(Simulation<2>(lonely, material, with_defaults({})).prepare(),
                "particle 66 at (3, 4) is singular", "0 neighbour(s)");
  Simulation<2>(lonely, material, {.operators = "standard"}).prepare();
}

TEST_CASE("a body compressed through itself breaks: what, which particle, where and when") {
  for (const char* name : {"neo_hookean", "corotated_svk", "st_venant_kirchhoff"}) {
    CAPTURE(name);
    auto s = simulation({}, name);
    constexpr double speed = 10;
    s.clamp(s.face("x_min"));
    s.prescribe(s.face("x_max"), 0, [](const Vec<2>&, double t) { return -speed * t; });
    s.roller(everywhere(), 1);  // or the sheet folds out of the way, with J > 0 everywhere
    int seen = 0;
    s.observe(0, [&](double) { ++seen; });
    const auto result = s.run(0.2);
    CHECK(result.status == Status::broke);
    CHECK(std::string(to_string(result.status)) == "broke");
    REQUIRE(result.breakdown.has_value());
    const Breakdown& b = *result.breakdown;
    CHECK(b.what == "J <= 0");
    REQUIRE(b.particle >= 0);
    REQUIRE(b.particle < static_cast<std::int64_t>(s.size()));
    const auto id = static_cast<std::size_t>(b.particle);
    CHECK(s.deformation_gradient(id)(0, 0) <= 0);
    for (int d = 0; d < 2; ++d) {
      CHECK(b.X[static_cast<std::size_t>(d)] == s.reference_position(id)[d]);
      CHECK(b.x[static_cast<std::size_t>(d)] == s.position(id)[d]);
    }
    CHECK(b.X[2] == 0);
    // Before the end has reached the clamp, in the step that the run ends with.
    CHECK(b.time > 0);
    CHECK(b.time < 1 / speed);
    CHECK(b.time == result.time);
    CHECK(b.time == s.time());
    CHECK(b.step == result.steps);
    CHECK(seen == result.steps + 1);
    // It still answers, and stays broken.
    CHECK(std::isfinite(s.displacement_at({1, 0.25})[0]));
    CHECK(s.velocity(id).size() == 2);
    const auto again = s.run(0.1);
    CHECK(again.status == Status::broke);
    CHECK(again.steps == 0);
    CHECK(s.relax({.max_steps = 100}).status == Status::broke);
  }
}

TEST_CASE("an updated Lagrangian body that is torn apart breaks") {
  auto s = simulation({.formulation = "ul_basic", .support_dx = 2.4}, "hypoelastic");
  s.clamp(s.face("x_min"));
  s.prescribe(s.face("x_max"), 0, [](const Vec<2>&, double t) { return 5 * t; });
  const auto result = s.run(0.5);
  REQUIRE(result.status == Status::broke);
  CHECK(result.breakdown->what == "lost neighbours");
  CHECK(std::isfinite(s.position(0)[0]));
}

TEST_CASE("a run that is stopped by its progress call is no breakdown") {
  auto s = simulation();
  const auto result = s.run(1, {.progress = [](std::int64_t steps, double, double) { return steps < 7; }});
  CHECK(result.status == Status::ok);
  CHECK(result.steps == 7);
  CHECK(result.time < 1);
  CHECK(s.time() == result.time);
}
