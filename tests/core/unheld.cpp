// Bodies that nothing holds have no equilibrium, which is said before the first step; and bodies that nothing
// loads are in one.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <taut/taut.hpp>

using namespace taut;

namespace {

struct Form {
  const char *name, *material;
  double support_dx;
};
const Form forms[] = {{"tl_displacement", "neo_hookean", 1.5},
                      {"tl_bond_associated", "neo_hookean", 1.5},
                      {"tl_stress_points", "neo_hookean", 1.5},
                      {"ul_artificial_stress", "hypoelastic", 2.4}};

template <int D>
Cloud<D> bar(double jitter = 0) {
  Vec<D> max = Vec<D>::Constant(0.05);
  max[0] = 0.2;
  return make_cloud(box<D>(Vec<D>::Zero(), max), {.dx = 0.0125, .jitter = jitter, .cells = true});
}
template <int D>
Simulation<D> simulation(Cloud<D> cloud, const Form& form = forms[0]) {
  return {std::move(cloud),
          make_material<D>(form.material, {.E = 2e6, .nu = 0.3, .density = 1000}),
          {.formulation = form.name, .support_dx = form.support_dx}};
}

template <int D>
std::string refusal(Simulation<D>& s) {
  try {
    s.check_relax();
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}
bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

template <int D>
Where<D> at_point(const Vec<D>& P) {
  return [P](const Vec<D>& X) { return (X - P).norm() < 1e-6; };
}

}  // namespace

TEST_CASE("unheld: a free bar under a load is refused in every form, and says what is free") {
  for (const Form& form : forms) {
    CAPTURE(form.name);
    auto s = simulation(bar<2>(), form);
    s.load(s.face("x_max"), {1000, 0});
    const std::string text = refusal(s);
    CAPTURE(text);
    CHECK(has(text, "nothing holds the body that contains particle 0 at (0, 0)"));
    CHECK(has(text, "free to move along x, y and to turn about z"));
    CHECK(has(text, "push it along x"));
    CHECK_THROWS_AS(s.relax(), InputError);
    CHECK(s.run(1e-4).status == Status::ok);  // it may well fly
  }
}

TEST_CASE("unheld: in one and three dimensions") {
  auto line = simulation(bar<1>());
  line.body_force(Vec<1>(9.81));
  CHECK(has(refusal(line), "free to move along x, and the loads push it along x"));
  auto block = simulation(bar<3>());
  block.load(block.face("z_max"), {0, 0, -10});
  CHECK(has(refusal(block), "along x, y, z and to turn about x, y, z, and the loads push it along z"));
  // A hinge along y at the foot: what stands on it tips over.
  auto hinged = simulation(bar<3>());
  hinged.clamp([](const Vec<3>& X) { return X[0] < 1e-6 && X[2] < 1e-6; });
  hinged.load(hinged.face("x_max"), {0, 0, -10});
  const std::string text = refusal(hinged);
  CAPTURE(text);
  CHECK(has(text, "the constraints do not hold"));
  CHECK(has(text, "it is free to turn about y, and the loads push it round"));
}

TEST_CASE("unheld: rollers on one face hold against what they face only") {
  const auto with_load = [](Vec<2> force) {
    auto s = simulation(bar<2>());
    s.roller(s.face("x_min"), 0);
    s.load(s.face("x_max"), force);
    return refusal(s);
  };
  CHECK(with_load({1000, 0}) == "");
  const std::string inclined = with_load({1000, 1e-3});
  CAPTURE(inclined);
  CHECK(has(inclined, "the constraints do not hold the body"));
  CHECK(has(inclined, "free to move along y, and the loads push it along y"));
  auto s = simulation(bar<2>());
  s.roller(s.face("x_min"), 0);
  s.load(s.face("x_max"), {1000, 0});
  CHECK(s.relax({.tolerance = 1e-4}).status == Status::ok);
  CHECK(s.displacement_at({0.2, 0.025})[0] > 1e-3);
}

TEST_CASE("unheld: loads that balance each other need no support") {
  for (const Form& form : {forms[0], forms[2]})
    for (const double jitter : {0.0, 0.2}) {
      CAPTURE(form.name);
      CAPTURE(jitter);
      auto s = simulation(bar<2>(jitter), form);
      s.load(s.face("x_max"), {1000, 0});
      s.load(s.face("x_min"), {-1000, 0});
      CHECK(refusal(s) == "");
      if (jitter > 0) continue;
      CHECK(s.relax({.tolerance = 1e-4}).status == Status::ok);
      const double longer = s.displacement_at({0.2, 0.025})[0] - s.displacement_at({0, 0.025})[0];
      CHECK(longer == doctest::Approx(0.2 * 1000 / 0.05 / 2e6 * (1 - 0.3 * 0.3)).epsilon(0.05));
    }
  auto couple = simulation(bar<2>());
  couple.load(couple.face("x_max"), {0, 10});
  couple.load(couple.face("x_min"), {0, -10});
  CHECK(has(refusal(couple), "and the loads push it round"));
  // Pulled hardly out of line, by 1 in 200: a turn of that angle is all it takes.
  auto out_of_line = simulation(bar<2>());
  out_of_line.load(out_of_line.face("x_max"), {1000, 5});
  out_of_line.load(out_of_line.face("x_min"), {-1000, -5});
  CHECK(refusal(out_of_line) == "");
  // Pushed instead of pulled, it tips over.
  auto pushed = simulation(bar<2>());
  pushed.load(pushed.face("x_max"), {-1000, 5});
  pushed.load(pushed.face("x_min"), {1000, -5});
  CHECK(has(refusal(pushed), "push it round"));
}

TEST_CASE("unheld: symmetry planes hold across themselves, prescribed motions as clamps do") {
  for (const Lattice lattice : {Lattice::node_centred, Lattice::cell_centred}) {
    const auto half = [&] {
      auto s = simulation(make_cloud(box<2>({0, 0}, {0.2, 0.05}), {.dx = 0.0125, .lattice = lattice}));
      s.symmetry_plane(0, 0);
      return s;
    };
    auto pulled = half();
    pulled.load(pulled.face("x_max"), {1000, 0});
    CHECK(refusal(pulled) == "");
    auto lifted = half();
    lifted.load(lifted.face("x_max"), {0, 10});
    CHECK(has(refusal(lifted), "free to move along y, and the loads push it along y"));
    auto quarter = half();
    quarter.symmetry_plane(1, 0);
    quarter.load(quarter.face("x_max"), {10, 10});
    CHECK(refusal(quarter) == "");
  }
  auto moved = simulation(bar<2>());
  moved.prescribe(moved.face("x_min"), 0, [](const Vec<2>&, double) { return 1e-3; });
  moved.prescribe(at_point<2>({0, 0}), 1, [](const Vec<2>&, double) { return 0.0; });
  moved.load(moved.face("x_max"), {10, 10});
  CHECK(refusal(moved) == "");
}

TEST_CASE("unheld: each body is asked for itself") {
  for (const Form& form : forms) {
    CAPTURE(form.name);
    auto s = simulation(make_cloud(box<2>({0, 0}, {0.2, 0.05}) | box<2>({0.3, 0}, {0.5, 0.05}),
                                   {.dx = 0.0125, .cells = true}),
                        form);
    s.clamp(s.face("x_min"));
    s.load(s.face("x_max"), {10, 0});
    const std::string text = refusal(s);
    CAPTURE(text);
    CHECK(has(text, "nothing holds the body that contains particle 17 at (0.3, 0)"));
  }
}

TEST_CASE("unheld: a load that comes later counts too") {
  auto s = simulation(bar<2>());
  s.load(s.face("x_max"), {10, 0}, [](double t) { return t < 0.1 ? 0.0 : 1.0; });
  CHECK(has(refusal(s), "push it along x"));
}

TEST_CASE("bodies without a load are in equilibrium at once") {
  for (const Form& form : forms) {
    CAPTURE(form.name);
    for (const bool zero_load : {false, true}) {
      auto s = simulation(bar<2>(), form);
      s.clamp(s.face("x_min"));
      if (zero_load) s.load(s.face("x_max"), {0, 0});
      const auto result = s.relax();
      CHECK(result.status == Status::ok);
      CHECK(result.steps <= 40);
      CHECK(s.displacement_at({0.2, 0.025}).norm() < 1e-12);
    }
    auto free = simulation(bar<2>(), form);
    CHECK(free.relax().status == Status::ok);
    auto held = simulation(bar<2>(), form);  // by displacements that are zero
    held.prescribe(held.face("x_min"), 0, [](const Vec<2>&, double) { return 0.0; });
    CHECK(held.relax().steps <= 40);
  }
}

TEST_CASE("what is strained without a load still has to find its equilibrium") {
  auto stretched = simulation(bar<2>());
  stretched.clamp(stretched.face("x_min"));
  stretched.set_displacement([](const Vec<2>& X) { return Vec<2>(1e-3 * X[0], 0); });
  const auto result = stretched.relax();
  CHECK(result.status == Status::ok);
  CHECK(result.steps > 100);
  CHECK(stretched.displacement_at({0.2, 0.025}).norm() < 2e-8);

  for (const double size : {1e-3, 1e-9}) {
    CAPTURE(size);
    auto pulled = simulation(bar<2>());
    pulled.clamp(pulled.face("x_min"));
    pulled.prescribe(pulled.face("x_max"), 0, [size](const Vec<2>&, double) { return size; });
    CHECK(pulled.relax({.tolerance = 1e-4}).status == Status::ok);
    CHECK(pulled.displacement_at({0.1, 0.025})[0] == doctest::Approx(size / 2).epsilon(0.02));
  }
  // At rest until it is moved.
  auto later = simulation(bar<2>());
  later.clamp(later.face("x_min"));
  later.load(later.face("x_max"), {100, 0}, [](double t) { return t < 0.02 ? 0.0 : 1.0; });
  CHECK(later.relax({.tolerance = 1e-4}).status == Status::ok);
  CHECK(later.displacement_at({0.2, 0.025})[0] > 1e-4);
}

TEST_CASE("steps that time does not see are refused") {
  auto s = simulation(bar<2>());
  for (const RunOptions& options : {RunOptions{.max_step = 1e-25}, RunOptions{.cfl = 1e-300}})
    CHECK_THROWS_WITH_AS(s.run(0.01, options), doctest::Contains("never reach 0.01 s"), InputError);
  CHECK_THROWS_WITH_AS(s.run(1e300), doctest::Contains("never reach 1e+300 s"), InputError);
  CHECK_THROWS_AS(s.check_run(0.01, {.max_step = 1e-25}), InputError);
  CHECK(s.run(1e-12).status == Status::ok);  // one short step
}

TEST_CASE("numbers out of range are refused or called by their name") {
  const auto of = [](MaterialParameters m, Cloud<2> cloud, Method method = with_defaults({})) {
    return Simulation<2>(std::move(cloud), make_material<2>("neo_hookean", m), std::move(method));
  };
  const MaterialParameters good{.E = 2e6, .nu = 0.3, .density = 1000};
  MaterialParameters stiff = good, weak = good, light = good;
  stiff.E = 1e308;
  light.density = 1e-320;
  weak.E = 1e-320;
  for (const auto& m : {stiff, weak, light}) CHECK_THROWS_AS(of(m, bar<2>()).prepare(), InputError);
  CHECK_THROWS_WITH_AS(of(light, bar<2>()).prepare(), doctest::Contains("neo_hookean"), InputError);
  for (const double V : {5e-324, 1e308}) {
    Cloud<2> cloud = bar<2>();
    cloud.V[7] = V;
    CHECK_THROWS_WITH_AS(of(good, cloud).prepare(), doctest::Contains("particle 7 has mass"), InputError);
  }
  CHECK_THROWS_WITH_AS(of(good, bar<2>(), {.zero_energy_control = 1e308}).prepare(),
                       doctest::Contains("stable step"), InputError);

  for (const char* name : {"tl_displacement", "tl_bond_associated", "tl_stress_points"}) {
    CAPTURE(name);
    auto thrown = of(good, bar<2>(), {.formulation = name});
    thrown.set_velocity(
        [](const Vec<2>& X) { return Vec<2>(X[0] > 0.1 ? 1e308 : 0, X[1] > 0.02 ? 1e308 : 0); });
    const auto result = thrown.run(0.01);
    REQUIRE(result.status == Status::broke);
    // A bond may be turned inside out by its other end, while the particle that it is told of is sound.
    if (name != std::string("tl_bond_associated")) CHECK(result.breakdown->what == "not a number");
    auto pulled = of(good, bar<2>(), {.formulation = name});
    pulled.clamp(pulled.face("x_min"));
    pulled.load(pulled.face("x_max"), {1e308, 0});
    const auto of_load = pulled.run(0.01);
    REQUIRE(of_load.status == Status::broke);
    CHECK(of_load.breakdown->what == "not a number");
  }
}
