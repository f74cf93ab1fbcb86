// What runs promise, whatever the integrator: a run that is cut in two or looked at gives the bits of one
// that is not, velocities are those of whole steps, orders and largest steps are what is stated.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <taut/integrators/integrator.hpp>
#include <vector>

#include "discretised.hpp"

using namespace taut;

namespace {

const std::vector<std::string> ours = {"leapfrog", "central_difference", "tvd_rk2", "ssp_rk3"};

/// A body in motion, one for each way in which a run keeps state.
Simulation<2> body(const std::string& kind) {
  const bool updated = kind == "ul_basic", walls = kind == "walls";
  LatticeOptions options{.dx = 0.1, .cells = kind == "tl_stress_points"};
  if (walls) options.lattice = Lattice::cell_centred;
  Method method;
  method.formulation = walls ? "tl_displacement" : kind;
  if (walls) method.operators = "compatible";
  if (updated) {
    method.support_dx = 2.4;
    method.viscosity = 0.3;
    method.skin = 0.02;
  }
  Simulation<2> s(
      make_cloud(box<2>({0, 0}, {0.8, 0.5}), options),
      make_material<2>(updated ? "hypoelastic" : "neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
      method);
  s.set_velocity([](const Vec<2>& X) { return wavy<2>(X, 2.0); });
  if (walls) {
    s.clamp(s.face("x_min"));
    s.prescribe(s.face("x_max"), 0, [](double t) { return 0.01 * std::sin(200 * t); });
    s.load(s.face("y_max"), {10, 20}, [](double t) { return std::cos(300 * t); });
  }
  return s;
}
const std::vector<std::string> kinds = {"tl_displacement", "tl_bond_associated", "tl_stress_points",
                                        "ul_basic", "walls"};

struct State {
  std::vector<double> x, v;
  double time;
  bool operator==(const State&) const = default;
};
State state_of(const Simulation<2>& s) {
  State state{{}, {}, s.time()};
  for (std::size_t i = 0; i < s.size(); ++i)
    for (int d = 0; d < 2; ++d) {
      state.x.push_back(s.displacement(i)[d]);
      state.v.push_back(s.velocity(i)[d]);
    }
  return state;
}
double distance(const State& a, const State& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.x.size(); ++i) sum += (a.x[i] - b.x[i]) * (a.x[i] - b.x[i]);
  return std::sqrt(sum);
}

constexpr double step = 1e-4;  // below the limits of all

}  // namespace

TEST_CASE("a run in many calls gives the bits of one") {
  constexpr int steps = 120;
  for (const auto& kind : kinds)
    for (const auto& integrator : ours) {
      CAPTURE(kind);
      CAPTURE(integrator);
      const double dt = integrator == "tvd_rk2" ? step / 10 : step;
      const RunOptions options{.integrator = integrator, .max_step = dt};
      auto whole = body(kind);
      const auto result = whole.run(steps * dt, options);
      CHECK(result.steps == steps);
      CHECK(result.status == Status::ok);
      for (const int calls : {2, 10, 40}) {
        CAPTURE(calls);
        auto parts = body(kind);
        std::int64_t made = 0;
        for (int call = 0; call < calls; ++call) made += parts.run(steps * dt / calls, options).steps;
        CHECK(made == steps);
        const State one = state_of(whole), many = state_of(parts);
        CHECK(one.x == many.x);
        CHECK(one.v == many.v);
        CHECK(many.time == doctest::Approx(one.time).epsilon(1e-14));
      }
    }
}

TEST_CASE("a run of thousand calls keeps the energy as one does") {
  // T = 0.2 s in 4000 steps; central differences had forgotten half a kick in each call.
  for (const std::string integrator : {"leapfrog", "central_difference"}) {
    CAPTURE(integrator);
    const RunOptions options{.integrator = integrator, .max_step = 0.2 / 4000};
    const auto block = [] {
      Simulation<2> s(make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 0.25}),
                      make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                      {.formulation = "tl_displacement"});
      s.set_velocity([](const Vec<2>& X) { return Vec<2>(X[0] - 0.5, 0.3 * X[1]); });
      s.prepare();
      return s;
    };
    auto one = block(), many = block();
    const double energy = one.kinetic_energy();
    one.run(0.2, options);
    for (int call = 0; call < 1000; ++call) many.run(0.2 / 1000, options);
    CHECK(state_of(one).x == state_of(many).x);
    CHECK(state_of(one).v == state_of(many).v);
    CHECK(std::abs((many.kinetic_energy() + many.strain_energy()) / energy - 1) < 1e-4);
  }
}

TEST_CASE("a run that is looked at gives the bits of one that is not") {
  for (const auto& kind : kinds)
    for (const auto& integrator : ours) {
      CAPTURE(kind);
      CAPTURE(integrator);
      auto seen = body(kind), unseen = body(kind);
      double sum = 0;
      int calls = 0;
      seen.observe(2.5 * step, [&](double) {
        ++calls;
        sum += seen.kinetic_energy() + seen.velocity(3).norm();
      });
      const auto look = [&](std::int64_t steps, double, double) {
        if (steps % 7 == 0) sum += seen.velocity(1).norm();
        return true;
      };
      const double dt = integrator == "tvd_rk2" ? step / 4 : step;
      seen.run(50 * step, {.integrator = integrator, .max_step = dt, .progress = look});
      unseen.run(50 * step, {.integrator = integrator, .max_step = dt});
      CHECK(calls == 21);
      CHECK(sum > 0);
      CHECK(state_of(seen) == state_of(unseen));
    }
}

TEST_CASE("another integrator, or a relaxation between two runs, goes on from the whole state") {
  auto s = body("tl_displacement");
  s.prepare();
  const double energy = s.kinetic_energy();
  for (const auto& integrator : ours) {
    CAPTURE(integrator);
    const auto result = s.run(20 * step, {.integrator = integrator, .max_step = step / 10});
    CHECK(result.status == Status::ok);
    CHECK(s.kinetic_energy() + s.strain_energy() == doctest::Approx(energy).epsilon(1e-4));
  }
  s.relax({.max_steps = 10});
  const double left = s.kinetic_energy() + s.strain_energy();
  CHECK(left < energy);
  s.run(20 * step, {.max_step = step / 10});
  CHECK(s.kinetic_energy() + s.strain_energy() == doctest::Approx(left).epsilon(1e-4));
}

TEST_CASE("a last step that is cut ends at the end, and the next run begins there") {
  auto s = body("tl_displacement");
  CHECK(s.run(2.5 * step, {.max_step = step}).steps == 3);
  CHECK(s.time() == 2.5 * step);
  CHECK(s.run(2 * step, {.max_step = step}).steps == 2);
  CHECK(s.time() == 2.5 * step + 2 * step);
  // Neither a sliver of a step nor a step that is a little shorter.
  CHECK(s.run((1 + 1e-9) * step, {.max_step = step}).steps == 1);
  CHECK(s.run((1 - 1e-9) * step, {.max_step = step}).steps == 1);
}

TEST_CASE("velocities are those of whole steps, also where an exception ends the run") {
  for (const auto& integrator : ours) {
    CAPTURE(integrator);
    const double dt = step / 10;
    auto s = body("tl_displacement");
    s.prepare();
    const double energy = s.kinetic_energy();
    const auto total = [&] { return s.kinetic_energy() + s.strain_energy(); };
    // Half a kick is some 1e-3 of the energy.
    s.run(40 * dt, {.integrator = integrator, .max_step = dt});
    CHECK(total() == doctest::Approx(energy).epsilon(2e-5));
    const auto stop = [](std::int64_t steps, double, double) { return steps < 7; };
    const auto thrown = [](std::int64_t steps, double, double) -> bool {
      if (steps == 7) throw std::runtime_error("enough");
      return true;
    };
    auto stopped = body("tl_displacement"), threw = body("tl_displacement"), seen = body("tl_displacement");
    stopped.run(1, {.integrator = integrator, .max_step = dt, .progress = stop});
    CHECK_THROWS_WITH(threw.run(1, {.integrator = integrator, .max_step = dt, .progress = thrown}), "enough");
    int calls = 0;
    seen.observe(0, [&](double) {
      if (++calls == 8) throw std::runtime_error("seen enough");
    });
    CHECK_THROWS_WITH(seen.run(1, {.integrator = integrator, .max_step = dt}), "seen enough");
    CHECK(state_of(threw) == state_of(stopped));
    CHECK(state_of(seen) == state_of(stopped));
    // And they go on from there.
    stopped.run(3 * dt, {.integrator = integrator, .max_step = dt});
    threw.run(3 * dt, {.integrator = integrator, .max_step = dt});
    CHECK(state_of(threw) == state_of(stopped));
  }
}

TEST_CASE("a block that oscillates has the order of the integrator in time") {
  const auto after = [](const std::string& integrator, int steps) {
    Simulation<2> s(make_cloud(box<2>({0, 0}, {0.6, 0.4}), {.dx = 0.1}),
                    make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                    {.formulation = "tl_displacement", .pair_precision = PairPrecision::double_precision});
    s.set_displacement([](const Vec<2>& X) { return Vec<2>(0.02 * std::cos(5.2 * X[0]), 0); });
    // A wall in motion: its velocity has to be of the order as well.
    s.prescribe(s.face("x_max"), 1, [](double t) { return 1e-2 * std::pow(std::sin(100 * t), 2); });
    constexpr double duration = 0.012;
    CHECK(s.run(duration, {.integrator = integrator, .cfl = 1e3, .max_step = duration / steps}).steps ==
          steps);
    return state_of(s);
  };
  const State exact = after("ssp_rk3", 4096);
  for (const std::string integrator : {"leapfrog", "tvd_rk2", "ssp_rk3"}) {
    CAPTURE(integrator);
    const double coarse = distance(after(integrator, 128), exact),
                 fine = distance(after(integrator, 256), exact);
    MESSAGE(integrator, ": order ", std::log2(coarse / fine), ", error ", fine);
    CHECK(std::log2(coarse / fine) == doctest::Approx(integrator == "ssp_rk3" ? 3 : 2).epsilon(0.05));
  }
}

TEST_CASE("updated Lagrangian bodies have the order of Runge-Kutta schemes") {
  const auto after = [](const std::string& integrator, int steps) {
    Simulation<2> s(make_cloud(box<2>({0, 0}, {0.6, 0.4}), {.dx = 0.1}),
                    make_material<2>("hypoelastic", {.E = 1e6, .nu = 0.3, .density = 1000}),
                    {.formulation = "ul_basic", .support_dx = 2.4, .skin = 0.3});
    s.set_velocity([](const Vec<2>& X) { return Vec<2>(0.5 * std::cos(5.2 * X[0]), 0.2 * X[1] * X[0]); });
    constexpr double duration = 0.006;
    CHECK(s.run(duration, {.integrator = integrator, .cfl = 1e3, .max_step = duration / steps}).steps ==
          steps);
    return state_of(s);
  };
  const State exact = after("ssp_rk3", 2048);
  for (const std::string integrator : {"tvd_rk2", "ssp_rk3"}) {
    CAPTURE(integrator);
    const double coarse = distance(after(integrator, 64), exact),
                 fine = distance(after(integrator, 128), exact);
    MESSAGE(integrator, ": order ", std::log2(coarse / fine), ", error ", fine);
    CHECK(std::log2(coarse / fine) == doctest::Approx(integrator == "ssp_rk3" ? 3 : 2).epsilon(0.05));
  }
}

TEST_CASE("bodies stay bounded up to the step that is stated, and no farther") {
  for (const std::string integrator : {"leapfrog", "ssp_rk3"}) {
    CAPTURE(integrator);
    const auto bounded = [&](double cfl) {
      // In 1D the frequency that the form states is that of its highest mode; elsewhere it may be a bound.
      Simulation<1> s(make_cloud(box<1>(Vec<1>(0), Vec<1>(1)), {.dx = 0.05}),
                      make_material<1>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                      {.formulation = "tl_displacement", .pair_precision = PairPrecision::double_precision});
      // Small and rough: all modes, and no other state than rest.
      s.set_velocity([](const Vec<1>& X) { return Vec<1>(1e-6 * std::sin(1000 * X[0] * X[0])); });
      s.prepare();
      const double energy = s.kinetic_energy();
      const auto few = [](std::int64_t steps, double, double) { return steps < 3000; };
      const auto result = s.run(1e9, {.integrator = integrator, .cfl = cfl, .max_step = 1, .progress = few});
      return result.status == Status::ok && s.kinetic_energy() < 10 * energy;
    };
    double low = 0.8, high = 1.25;
    REQUIRE(bounded(low));
    REQUIRE_FALSE(bounded(high));
    while (high - low > 2e-3) (bounded((low + high) / 2) ? low : high) = (low + high) / 2;
    MESSAGE(integrator, ": bounded up to ", low, " of the step that is stated");
    CHECK(low == doctest::Approx(1).epsilon(0.03));
  }
}

TEST_CASE("relaxation: a second ramp does not unload, one that was stopped does not go on") {
  const auto beam = [] {
    Simulation<2> s(make_cloud(box<2>({0, 0}, {0.8, 0.2}), {.dx = 0.1}),
                    make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                    {.formulation = "tl_displacement"});
    s.clamp(s.face("x_min"));
    s.body_force({30, 0});
    return s;
  };
  const auto tip = [](const Simulation<2>& s) { return s.displacement_at({0.8, 0.1})[0]; };
  constexpr double ramp = 0.1;
  auto direct = beam();
  CHECK(direct.relax({.tolerance = 1e-8}).status == Status::ok);
  const double u = tip(direct);
  REQUIRE(u > 1e-4);

  auto twice = beam();
  CHECK(twice.relax({.tolerance = 1e-8, .ramp_time = ramp}).status == Status::ok);
  CHECK(tip(twice) == doctest::Approx(u).epsilon(1e-5));
  double least = u;
  const auto watch = [&](std::int64_t, double, double) {
    least = std::min(least, tip(twice));
    return true;
  };
  CHECK(twice.relax({.tolerance = 1e-8, .ramp_time = ramp, .progress = watch}).status == Status::ok);
  CHECK(least == doctest::Approx(u).epsilon(1e-4));

  // After a run that had all loads there is nothing to ramp up either.
  auto after_run = beam();
  after_run.run(1e-3);
  after_run.relax({.ramp_time = 1e9, .max_steps = 1});
  CHECK(after_run.acceleration(after_run.size() - 1)[0] > 15);
  CHECK(after_run.relax({.tolerance = 1e-8, .ramp_time = 1e9}).status == Status::ok);  // nor to wait for
  CHECK(tip(after_run) == doctest::Approx(u).epsilon(1e-5));

  const std::size_t far = direct.size() - 1;
  const auto stop_at = [&](double level, const Simulation<2>&) {
    return [=](std::int64_t, double t, double) {
      const double q = t / ramp;
      return q * q * (3 - 2 * q) < level;
    };
  };
  auto stopped = beam();
  CHECK(stopped.relax({.ramp_time = ramp, .progress = stop_at(0.4, stopped)}).status ==
        Status::not_converged);
  const double t = stopped.time(), q = t / ramp, level = q * q * (3 - 2 * q);
  CHECK(level > 0.4);
  CHECK(level < 0.6);
  const double before = stopped.acceleration(far)[0];
  // It goes on from what acts …
  stopped.relax({.ramp_time = 1e9, .max_steps = 1});
  CHECK(std::abs(stopped.acceleration(far)[0] - before) < 1);
  // … and a run has all of it, at once and without a ramp.
  auto again = beam();
  again.relax({.ramp_time = ramp, .progress = stop_at(0.4, again)});
  again.run(0);
  CHECK(again.acceleration(far)[0] - before == doctest::Approx((1 - level) * 30).epsilon(1e-6));
  again.run(1e-5, {.max_step = 1e-6});
  CHECK(again.acceleration(far)[0] - before == doctest::Approx((1 - level) * 30).epsilon(1e-2));
  CHECK(again.relax({.tolerance = 1e-8}).status == Status::ok);
  CHECK(tip(again) == doctest::Approx(u).epsilon(1e-5));

  auto threw = beam();
  const auto thrown = [](std::int64_t, double, double) -> bool { throw std::runtime_error("enough"); };
  CHECK_THROWS(threw.relax({.ramp_time = ramp, .progress = thrown}));
  CHECK(threw.relax({.tolerance = 1e-8}).status == Status::ok);
  CHECK(tip(threw) == doctest::Approx(u).epsilon(1e-5));
}

TEST_CASE("prescribed motion: histories of all and of each particle, never before the start") {
  const auto sheet = [] {
    return Simulation<2>(make_cloud(box<2>({0, 0}, {0.4, 0.4}), {.dx = 0.1}),
                         make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                         {.formulation = "tl_displacement"});
  };
  const auto u = [](double t) {
    if (t < 0) throw std::logic_error("before the start");
    return 1e-2 * std::sin(50 * t) + 5.0;
  };
  const auto all_over = [](const Vec<2>&) { return true; };
  auto one = sheet(), two = sheet(), three = sheet();
  one.prescribe(all_over, 0, u);
  two.prescribe(all_over, 0, [&](const Vec<2>&, double t) { return u(t); });
  three.prescribe(all_over, 0, u, [](double t) { return 0.5 * std::cos(50 * t); });
  for (auto* s : {&one, &two, &three}) {
    CHECK(s->run(10 * step, {.max_step = step}).status == Status::ok);
    CHECK(s->displacement(7)[0] == u(s->time()));
    CHECK(s->velocity(7)[0] == doctest::Approx(0.5 * std::cos(50 * s->time())).epsilon(1e-8));
  }
  CHECK(three.velocity(7)[0] == 0.5 * std::cos(50 * (10 * step)));
  CHECK(state_of(one) == state_of(two));
}
