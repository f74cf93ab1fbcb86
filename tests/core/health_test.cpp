#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <taut/taut.hpp>

using namespace taut;

namespace {

double value(const Health& health, const std::string& name) {
  const HealthMeasure* m = health.find(name);
  REQUIRE(m);
  return m->value;
}

Simulation<2> square(const Method& method, double jitter = 0, const char* material = "neo_hookean") {
  return {make_cloud(box<2>({0, 0}, {0.1, 0.05}), {.dx = 0.005, .jitter = jitter, .cells = true}),
          make_material<2>(material, {.E = 1e6, .nu = 0.3, .density = 1000}), with_defaults(method)};
}

}  // namespace

TEST_CASE(
    "a measure is flagged beyond its limit, below it where it counts from below, and when it is no number") {
  HealthMeasure m{"health_x", 0.2, 0.1, false, "", -1, {}};
  CHECK(m.flagged());
  m.from_below = true;
  CHECK(!m.flagged());
  m.value = 0.05;
  CHECK(m.flagged());
  m = {"health_x", std::nan(""), 0.1, false, "", -1, {}};
  CHECK(m.flagged());
  Health health;
  CHECK(!health.suspect());
  CHECK(health.complaints() == "");
  m = {"health_x", 0.2, 0.1, false, "", -1, {}};
  health.measures = {{"health_y", 0, 1, false, "", -1, {}}, m};
  CHECK(health.suspect());
  CHECK(health.complaints() == "health_x 0.2 (limit 0.1)");
}

TEST_CASE("health at set-up: a lattice is well, a jittered one is not unless closed") {
  Simulation<2> s = square({});
  CHECK_THROWS_AS(s.health(), InputError);
  s.prepare();
  CHECK(!s.health().suspect());
  CHECK(value(s.health(), "health_linear_field_error") < 1e-5);
  CHECK(value(s.health(), "health_spurious_force") < 1e-4);
  CHECK(value(s.health(), "health_volume_error") < 1e-12);
  CHECK(value(s.health(), "health_frequency") > 1);
  CHECK(value(s.health(), "health_frequency") < 4);
  CHECK(value(s.health(), "health_fewest_neighbours") == 3);
  CHECK(value(s.health(), "health_thickness") == 9);

  Simulation<2> jittered = square({}, 0.2);
  jittered.prepare();
  CHECK(jittered.health().suspect());
  CHECK(jittered.health().find("health_spurious_force")->particle >= 0);
  Method closed;
  closed.operators = "compatible";
  Simulation<2> compatible = square(closed, 0.2);
  compatible.prepare();
  CHECK(value(compatible.health(), "health_spurious_force") <
        0.1 * value(jittered.health(), "health_spurious_force"));
  CHECK(!compatible.health().suspect());
}

TEST_CASE("health at set-up: a body that the lattice does not resolve has another volume") {
  const auto error = [](double radius) {
    Simulation<2> s(make_cloud(box<2>({0, 0}, {1, 1}) - sphere<2>({0.5, 0.5}, radius), {.dx = 0.1}),
                    make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}), {});
    s.prepare();
    return value(s.health(), "health_volume_error");
  };
  // Between the cells' middles, so that the lattice has no hole at all.
  CHECK(error(0.06) == doctest::Approx(std::numbers::pi * 0.06 * 0.06).epsilon(0.3));
}

TEST_CASE("health at set-up: operators that are sick are refused with the particle") {
  Cloud<2> cloud = make_cloud(box<2>({0, 0}, {0.1, 0.05}), {.dx = 0.005});
  cloud.V[57] *= 1e-6;
  Simulation<2> s(cloud, make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}), {});
  std::string message;
  try {
    s.prepare();
  } catch (const InputError& error) {
    message = error.what();
  }
  CHECK(message.find("particle 57") != std::string::npos);
  // Nothing is half made: it says so again.
  CHECK_THROWS_AS(s.prepare(), InputError);
}

TEST_CASE("health of a run: what neighbours do and gradients do not see") {
  // A rigid motion and a homogeneous deformation are seen whole; the mode that changes sign from particle to
  // particle is not seen at all.
  const auto rough = [](const Method& method, const std::function<Vec<2>(const Vec<2>&)>& u) {
    Simulation<2> s = square(method);
    s.set_displacement(u);
    return s.run(0).health;
  };
  const auto linear = [](const Vec<2>& X) { return Vec<2>(0.1 * X.x() + 0.05 * X.y(), -0.02 * X.y()); };
  const auto saw = [](const Vec<2>& X) {
    const long k = std::lround(X.x() / 0.005) + std::lround(X.y() / 0.005);
    return Vec<2>(1e-5 * (k % 2 ? 1 : -1), 0);
  };
  Method uncontrolled;
  uncontrolled.formulation = "tl_stress_points";
  uncontrolled.zero_energy_control = 0;
  Method cells;
  cells.formulation = "tl_stress_points";
  for (const Method& m : {Method{}, uncontrolled, cells}) {
    CAPTURE(m.formulation);
    CHECK(value(rough(m, linear), "health_roughness") < 1e-9);
  }
  CHECK(value(rough({}, saw), "health_roughness") > 1);
  CHECK(rough({}, saw).suspect());
  CHECK(value(rough(uncontrolled, saw), "health_roughness") > 0.5);
  CHECK(value(rough(cells, saw), "health_roughness") == 0);
}

TEST_CASE("health of a run: energy and momenta of a free body") {
  for (const char* formulation : {"tl_displacement", "tl_stress_points"}) {
    Method m = with_defaults({});
    m.formulation = formulation;
    Simulation<2> s = square(m);
    s.set_velocity([](const Vec<2>& X) { return Vec<2>(1 - 20 * X.y(), 20 * X.x()); });
    const RunResult r = s.run(0.05);
    CHECK(r.status == Status::ok);
    CAPTURE(r.health.complaints());
    CHECK(value(r.health, "health_energy_error") < 1e-3);
    CHECK(value(r.health, "health_momentum_error") < 1e-12);
    CHECK(value(r.health, "health_spin_error") < 1e-10);
    CHECK(!r.suspect());
    CHECK(s.health().measures.size() == r.health.measures.size());
  }
  // Loads that change do work that is not counted: no balance then.
  Simulation<2> s = square({});
  s.clamp(s.face("x_min"));
  s.load(s.face("x_max"), {1, 0}, [](double t) { return t; });
  CHECK(!s.run(1e-4).health.find("health_energy_error"));
  Simulation<2> constant = square({});
  constant.clamp(constant.face("x_min"));
  constant.load(constant.face("x_max"), {100, 0});
  const RunResult r = constant.run(0.02);
  CHECK(value(r.health, "health_energy_error") < 1e-2);
  CHECK(!r.health.find("health_momentum_error"));
}
