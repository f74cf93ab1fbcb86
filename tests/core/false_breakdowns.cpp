// Bodies are judged by how they deform, not by how fast they fly: the check on runaway energy.
#include <doctest/doctest.h>

#include <limits>
#include <memory>
#include <taut/formulations/assembly.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/taut.hpp>

using namespace taut;

namespace {

// Waves of 1.16 m/s.
const MaterialParameters jelly{.E = 1e3, .nu = 0.3, .density = 1000};
constexpr double waves = 1.16;

struct Form {
  const char *name, *material;
  double support_dx;
};
const Form forms[] = {{"tl_displacement", "neo_hookean", 1.5},
                      {"tl_bond_associated", "neo_hookean", 1.5},
                      {"tl_stress_points", "neo_hookean", 1.5},
                      {"ul_basic", "hypoelastic", 2.4},
                      {"ul_artificial_stress", "hypoelastic", 2.4}};

Cloud<2> two_squares() {
  return make_cloud(box<2>({0, 0}, {0.5, 0.5}) | box<2>({1, 0}, {1.5, 0.5}), {.dx = 0.1, .cells = true});
}
Simulation<2> jelly_of(Cloud<2> cloud, const Form& form) {
  return {std::move(cloud),
          make_material<2>(form.material, jelly),
          {.formulation = form.name, .support_dx = form.support_dx}};
}

// Particles of two squares under a formulation, whose velocities tests set as they like.
struct LaidOpen {
  Method method = with_defaults({});
  std::shared_ptr<const Material<2>> material;
  Particles<2> p;
  Constraints<2> constraints;
  Loads<2> loads;
  std::unique_ptr<Formulation<2>> formulation;

  explicit LaidOpen(const Form& form)
      : method(with_defaults({.formulation = form.name, .support_dx = form.support_dx})),
        material(make_material<2>(form.material, jelly)) {
    const Cloud<2> cloud = two_squares();
    p = assemble<2>(cloud, {material}, std::vector<std::uint8_t>(cloud.size(), 0),
                    {{}, {}, form.support_dx * cloud.dx * 1.1});
    formulation = make_formulation<2>({p, constraints, loads, method});
  }
  std::string judged() {
    formulation->inspect();
    return formulation->failure() ? formulation->failure()->what : "";
  }
};

}  // namespace

TEST_CASE("soft bodies that fly apart at a hundred times their waves do not break") {
  for (const Form& form : forms) {
    CAPTURE(form.name);
    auto s = jelly_of(two_squares(), form);
    s.set_velocity([](const Vec<2>& X) { return Vec<2>(X[0] < 0.75 ? -100 : 100, 30); });
    const auto result =
        s.run(1e3, {.progress = [](std::int64_t steps, double, double) { return steps < 200; }});
    CHECK(result.status == Status::ok);
    CHECK(result.steps == 200);
    CHECK(s.velocity(0)[0] == doctest::Approx(-100).epsilon(1e-3));
  }
}

TEST_CASE("a soft body that falls faster than its waves does not break") {
  for (const Form& form : forms) {
    CAPTURE(form.name);
    auto s = jelly_of(make_cloud(box<2>({0, 0}, {0.5, 0.5}), {.dx = 0.1, .cells = true}), form);
    s.body_force({0, -1000});
    const auto result = s.run(1);
    CHECK(result.status == Status::ok);
    CHECK(s.velocity(0)[1] == doctest::Approx(-1000).epsilon(1e-3));
  }
}

TEST_CASE("what tears the body is still seen, in every form") {
  for (const Form& form : forms) {
    CAPTURE(form.name);
    LaidOpen whole(form);
    const auto flies = [&](Index i) { return Vec<2>(whole.p.X.vec<2>(i)[0] < 0.75 ? -1e6 : 1e6, 3e5); };
    for (Index i = 0; i < whole.p.n; ++i) whole.p.v.set_vec<2>(i, flies(i));
    CHECK(whole.judged() == "");
    // One particle of the slowest kind that counts, wherever it stands.
    for (Index at = 0; at < whole.p.n; at += 5) {
      LaidOpen torn(form);
      for (Index i = 0; i < torn.p.n; ++i) torn.p.v.set_vec<2>(i, flies(i));
      torn.p.v.set_vec<2>(at, flies(at) + Vec<2>(0, 19 * waves));
      CHECK(torn.judged() == "");
      torn.p.v.set_vec<2>(at, flies(at) + Vec<2>(0, 21 * waves));
      CHECK(torn.judged() == "runaway energy");
      const Index blamed = torn.formulation->failure()->particle;
      CHECK((torn.p.X.vec<2>(blamed) - torn.p.X.vec<2>(at)).norm() <= form.support_dx * 0.1 * (1 + 1e-9));
    }
    LaidOpen lost(form);
    lost.p.v.set_vec<2>(17, Vec<2>(0, std::numeric_limits<double>::quiet_NaN()));
    CHECK(lost.judged() == "not a number");
    CHECK(lost.formulation->failure()->particle == 17);
  }
}

TEST_CASE("a body that nothing keeps from gaining energy breaks") {
  for (const Form& form : forms) {
    CAPTURE(form.name);
    auto s = jelly_of(make_cloud(box<2>({0, 0}, {0.5, 0.5}), {.dx = 0.1, .cells = true}), form);
    s.set_velocity([](const Vec<2>& X) { return Vec<2>(100 + 1e-3 * X[1] * X[1], 0); });
    const auto result =
        s.run(1e3, {.cfl = 3, .max_step = 1, .progress = [](std::int64_t steps, double, double) {
                      return steps < 1000;
                    }});
    CHECK(result.status == Status::broke);
  }
}
