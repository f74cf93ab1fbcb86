#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <taut/taut.hpp>

// Periodic boxes, and images that follow particles.

using namespace taut;

namespace {

struct Form {
  std::string formulation, operators;
  bool nodes = false;
  bool updated = false;
};

const std::vector<Form> forms = {
    {"tl_displacement", "corrected"},    {"tl_displacement", "compatible"},
    {"tl_bond_associated", "corrected"}, {"tl_stress_points", "", true},
    {"ul_basic", "", false, true},       {"ul_artificial_stress", "", false, true}};

template <int D>
Simulation<D> box_of(const Form& form, const Vec<D>& size, double dx, double jitter = 0) {
  LatticeOptions options{.dx = dx};
  options.lattice = form.nodes ? Lattice::node_centred : Lattice::cell_centred;
  options.jitter = jitter;
  const auto material =
      make_material<D>(form.updated ? "hypoelastic" : "neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000});
  Method method;
  method.formulation = form.formulation;
  method.operators = form.operators;
  if (form.updated) {
    method.kernel = "wendland_c2";
    method.support_dx = 2.4;
  }
  Simulation<D> simulation(make_cloud(box<D>(Vec<D>::Zero(), size), options), material, method);
  for (int d = 0; d < D; ++d) simulation.periodic(d, 0, size[d]);
  return simulation;
}

}  // namespace

TEST_CASE_TEMPLATE("periodic: a constant stress pushes nothing", Dimension, std::integral_constant<int, 1>,
                   std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
  constexpr int D = Dimension::value;
  for (const Form& form : forms) {
    if (form.nodes) continue;
    CAPTURE(form.formulation);
    CAPTURE(form.operators);
    Simulation<D> s = box_of<D>(form, Vec<D>::Constant(0.6), 0.1);
    s.prepare();
    const HealthMeasure* spurious = s.health().find("health_spurious_force");
    REQUIRE(spurious);
    CHECK(spurious->value < 1e-12);
    // No particle is on a surface.
    CHECK(s.health().find("health_spurious_face_force") == nullptr);
  }
}

TEST_CASE("periodic: a plane wave is the same in a box of 8 and of 16 cells, and momentum is kept") {
  constexpr double dx = 0.1, amplitude = 1e-3, duration = 0.007;
  const double k = 2 * std::numbers::pi / (8 * dx);
  const auto velocity = [&](const Vec<2>& X) { return Vec<2>(amplitude * std::sin(k * X[0]) + 0.5, 0); };
  for (const Form& form : forms) {
    CAPTURE(form.formulation);
    CAPTURE(form.operators);
    std::vector<double> at;
    for (const int cells : {8, 16}) {
      Simulation<2> s = box_of<2>(form, {cells * dx, 4 * dx}, dx);
      s.set_velocity(velocity);
      s.prepare();
      const Vec<2> before = s.linear_momentum();
      const RunResult result = s.run(duration, {.max_step = 2e-4});
      REQUIRE(!result.breakdown);
      CHECK((s.linear_momentum() - before).norm() < 1e-11 * before.norm());
      // The phase of the wave, by projection: shared by all particles of the box.
      double sum = 0, squares = 0;
      for (std::size_t i = 0; i < s.size(); ++i) {
        const double of = std::sin(k * s.reference_position(i)[0]);
        sum += s.mass(i) * of * (s.displacement(i)[0] - 0.5 * duration);
        squares += s.mass(i) * of * of;
      }
      at.push_back(sum / squares);
    }
    // About a third of a period, so that the frequency shows: without a restoring force this would be 1.
    CHECK(std::abs(at[0]) > 0.1 * amplitude * duration);
    CHECK(std::abs(at[1] / at[0] - 1) < 1e-9);
  }
}

TEST_CASE("periodic: a layer under a sideways weight") {
  // u = rho g (H y - y^2 / 2) / mu whatever the period is.
  constexpr double height = 1, dx = 1.0 / 12, g = 0.1, mu = 1e6 / 2.6;
  for (const Form& form : forms) {
    if (form.updated || form.operators == "corrected") continue;
    CAPTURE(form.formulation);
    LatticeOptions options{.dx = dx};
    options.lattice = form.nodes ? Lattice::node_centred : Lattice::cell_centred;
    Method method;
    method.formulation = form.formulation;
    method.operators = form.operators;
    Simulation<2> s(make_cloud(box<2>({0, 0}, {4 * dx, height}), options),
                    make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}), method);
    s.periodic(0, 0, 4 * dx);
    s.clamp(s.face("y_min"));
    s.body_force({g, 0});
    const RunResult result = s.relax({.tolerance = 1e-6});
    REQUIRE(!result.breakdown);
    const double exact = 1000 * g * height * height / (2 * mu);
    CHECK(s.displacement_at({2 * dx, height})[0] == doctest::Approx(exact).epsilon(0.02));
    for (std::size_t i = 0; i < s.size(); ++i) CHECK(std::abs(s.displacement(i)[1]) < 1e-3 * exact);
  }
}

TEST_CASE("periodic: what flows through the box goes on as if nothing were there") {
  // A drift of several periods: updated forms find neighbours across the ends anew.
  for (const char* name : {"ul_basic", "ul_artificial_stress"}) {
    Simulation<2> s = box_of<2>({name, "", false, true}, {0.8, 0.4}, 0.1);
    s.set_velocity([](const Vec<2>&) { return Vec<2>(30, 10); });
    const RunResult result = s.run(0.1, {.cfl = 0.3});
    REQUIRE(!result.breakdown);
    for (std::size_t i = 0; i < s.size(); ++i) CHECK((s.displacement(i) - Vec<2>(3, 1)).norm() < 1e-9);
  }
}

TEST_CASE_TEMPLATE("images follow: a body dropped onto a symmetry plane bounces off its image", Dimension,
                   std::integral_constant<int, 1>, std::integral_constant<int, 2>,
                   std::integral_constant<int, 3>) {
  constexpr int D = Dimension::value;
  Method method;
  method.formulation = "ul_basic";
  method.kernel = "wendland_c2";
  method.support_dx = 2.4;
  constexpr double dx = 0.05, gap = 0.2, speed = 0.1, height = 0.2;
  LatticeOptions options{.dx = dx};
  options.lattice = Lattice::cell_centred;
  Vec<D> low = Vec<D>::Zero(), high = Vec<D>::Constant(0.2);
  low[D - 1] = gap;
  high[D - 1] = gap + height;
  // Slow enough for the meeting to last many periods: a fast one leaves vibrations in the body.
  Simulation<D> s(make_cloud(box<D>(low, high), options),
                  make_material<D>("hypoelastic", {.E = 1e6, .nu = 0.3, .density = 1000}), method);
  s.symmetry_plane(D - 1, 0);
  s.set_velocity([](const Vec<D>&) { return Vec<D>(-speed * Vec<D>::Unit(D - 1)); });
  s.prepare();
  const double before = s.linear_momentum()[D - 1];
  const RunResult result = s.run(3 * gap / speed, {.cfl = 0.3});
  CHECK(!result.breakdown);
  CHECK(std::abs(s.linear_momentum()[D - 1] / before + 1) < 0.02);
}

TEST_CASE("periodic: what does not fit is said") {
  LatticeOptions options{.dx = 0.1};
  const auto cloud = make_cloud(box<2>({0, 0}, {1, 0.4}), options);
  const auto material = make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000});
  Method method;
  method.formulation = "tl_displacement";
  {
    Simulation<2> s(cloud, material, method);
    s.periodic(0, 0, 1);
    CHECK_THROWS_WITH_AS(s.prepare(), doctest::Contains("both ends of the period"), InputError);
  }
  {
    Simulation<2> s(cloud, material, method);
    s.periodic(0, 0, 0.9);
    CHECK_THROWS_WITH_AS(s.prepare(), doctest::Contains("does not hold the body"), InputError);
  }
  Simulation<2> s(cloud, material, method);
  CHECK_THROWS_AS(s.periodic(2, 0, 1), InputError);
  CHECK_THROWS_AS(s.periodic(0, 1, 0), InputError);
  s.periodic(0, 0, 1);
  CHECK_THROWS_AS(s.periodic(0, 0, 1), InputError);
  CHECK_THROWS_AS(s.symmetry_plane(0, 0), InputError);
}
