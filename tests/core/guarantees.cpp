// What the library guarantees when something goes wrong, by the numbers of the faults that were found: F3 (a
// set-up that throws), F7, F9 (observers, clouds, moves), F15 and F20 (arguments).
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <core/refusal.hpp>
#include <fstream>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <taut/taut.hpp>
#include <vector>

using namespace taut;
using taut::test::refusal;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
const MaterialParameters rubber{.E = 1e6, .nu = 0.3, .density = 1000};

struct Boom : std::runtime_error {
  Boom() : std::runtime_error("boom") {}
};

// Throws at one call, the `at`-th, of all that share it.
struct Fuse {
  long at = -1, calls = 0;
  void burn() {
    if (calls++ == at) throw Boom();
  }
};

Cloud<2> sheet(Lattice lattice = Lattice::node_centred) {
  return make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1, .lattice = lattice});
}
std::shared_ptr<const Material<2>> material() { return make_material<2>("neo_hookean", rubber); }
Simulation<2> simulation(const Method& method = {}) { return {sheet(), material(), method}; }

Where<2> everywhere() {
  return [](const Vec<2>&) { return true; };
}

// All that a simulation can call, with a fuse in it.
Simulation<2> fused(const Method& method, Lattice lattice, const std::shared_ptr<Fuse>& fuse) {
  Simulation<2> s(sheet(lattice), material(), method);
  s.set_material([](const Vec<2>& X) { return X[0] > 0.6; },
                 make_material<2>("neo_hookean", {.E = 2e6, .nu = 0.2, .density = 1500}));
  s.clamp(s.face("x_min"));
  s.prescribe(s.face("y_min"), 1, [fuse](const Vec<2>& X, double t) {
    fuse->burn();
    return 1e-4 * X[0] * (1 + t);
  });
  s.load(s.face("x_max"), {100, 0}, [fuse](double t) {
    fuse->burn();
    return 1 + t;
  });
  s.body_force({0, -1}, [fuse](double) {
    fuse->burn();
    return 1.0;
  });
  s.set_displacement([fuse](const Vec<2>& X) {
    fuse->burn();
    return Vec<2>(1e-4 * X[0], 0);
  });
  s.set_velocity([fuse](const Vec<2>& X) {
    fuse->burn();
    return Vec<2>(0, 1e-2 * X[0]);
  });
  return s;
}

bool same_state(const Simulation<2>& a, const Simulation<2>& b) {
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a.displacement(i) != b.displacement(i) || a.velocity(i) != b.velocity(i)) return false;
  return a.time() == b.time();
}

// Relative to the largest, of displacements and velocities.
double difference(const Simulation<2>& a, const Simulation<2>& b) {
  double u = 0, v = 0, u_off = 0, v_off = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    u = std::max(u, b.displacement(i).norm());
    v = std::max(v, b.velocity(i).norm());
    u_off = std::max(u_off, (a.displacement(i) - b.displacement(i)).norm());
    v_off = std::max(v_off, (a.velocity(i) - b.velocity(i)).norm());
  }
  return std::max(u_off / u, v_off / v);
}

}  // namespace

TEST_CASE("F3: a set-up that throws leaves the simulation as it was") {
  struct Kind {
    Method method;
    Lattice lattice;
  };
  const std::vector<Kind> kinds = {
      {{.formulation = "tl_displacement"}, Lattice::node_centred},
      {{.formulation = "tl_displacement", .operators = "compatible"}, Lattice::cell_centred},
      {{.formulation = "tl_stress_points"}, Lattice::node_centred},
  };
  for (const Kind& kind : kinds)
    for (const bool dynamic : {true, false}) {
      CAPTURE(kind.method.formulation);
      CAPTURE(kind.method.operators);
      CAPTURE(dynamic);
      const auto go = [&](Simulation<2>& s) {
        if (dynamic)
          s.run(2e-2);
        else
          s.relax({.max_steps = 20});
      };
      const auto quiet = std::make_shared<Fuse>();
      auto right = fused(kind.method, kind.lattice, quiet);
      right.prepare();
      const long in_setup = quiet->calls;
      CHECK(in_setup >= 100);  // initial displacements and velocities of all particles
      go(right);
      const long in_all = quiet->calls;
      int as_before = 0, lost = 0;  // after the throw
      for (long at = 0; at < in_all; at += at < in_setup + 400 ? 7 : 211) {
        const auto fuse = std::make_shared<Fuse>();
        auto s = fused(kind.method, kind.lattice, fuse);
        fuse->at = at;
        CHECK_THROWS_AS(go(s), Boom);
        if (at < in_setup) {
          CHECK_THROWS_AS(s.velocity(0), InputError);  // not prepared
          CHECK(s.displacement(3) == Vec<2>(0, 0));
        }
        const bool between_steps = s.time() > 0;
        try {
          go(s);
          if (between_steps) continue;  // goes on from the last one
          ++as_before;
          CAPTURE(at);
          if (at < in_setup)
            CHECK(same_state(s, right));
          else  // prescribed velocities are differences over a part of a step, whose length was found anew
            CHECK(difference(s, right) < 1e-9);
        } catch (const RunError& error) {
          ++lost;
          CHECK(std::string(error.what()).find("cannot go on") != std::string::npos);
          CHECK(at > in_setup);
        }
      }
      CHECK(as_before > in_setup / 7 + 3);
      CHECK(lost > 10);
    }
}

TEST_CASE("F3: a load does not count twice, nor are velocities lost") {
  // The reproduction that was found.
  const auto tip = [](bool throws) {
    auto s = simulation({.formulation = "tl_displacement"});
    s.clamp(s.face("x_min"));
    s.load(s.face("x_max"), {100, 0});
    bool armed = throws;
    s.set_displacement([&](const Vec<2>&) {
      if (armed) throw Boom();
      return Vec<2>(0, 0);
    });
    s.set_velocity([](const Vec<2>& X) { return Vec<2>(X[0], 0); });
    if (throws) CHECK_THROWS_AS(s.prepare(), Boom);
    armed = false;
    s.run(1e-3);
    return s.displacement(10);
  };
  CHECK(tip(true) == tip(false));
}

TEST_CASE("F3: operators that cannot be made leave the simulation open") {
  Cloud<2> cloud = sheet();
  cloud.X.emplace_back(3, 4);  // has no neighbours
  cloud.V.push_back(0.01);
  cloud.B.emplace_back(0, 0);
  cloud.cells = {};
  Simulation<2> s(cloud, material(), {.operators = "corrected"});
  for (int k = 0; k < 3; ++k) CHECK_REFUSED(s.prepare(), "particle 66", "singular");
  s.clamp(s.face("x_min"));  // not too late
  CHECK_REFUSED(s.velocity(0), "only after");
}

TEST_CASE("F3: a region whose predicate throws gets no part of a material") {
  const auto moved = [](bool throws) {
    Simulation<2> s(sheet(), material(), {.formulation = "tl_stress_points"});
    if (throws)
      for (const long at : {0, 30, 70}) {  // among the particles, and among the cells
        Fuse fuse{at};
        CHECK_THROWS_AS(s.set_material(
                            [&](const Vec<2>&) {
                              fuse.burn();
                              return true;
                            },
                            make_material<2>("neo_hookean", {.E = 1e7, .nu = 0.3, .density = 4000})),
                        Boom);
      }
    CHECK(s.mass(30) == doctest::Approx(10));
    s.set_velocity([](const Vec<2>& X) { return Vec<2>(X[0], 0); });
    s.run(1e-3);
    return s.displacement(12);
  };
  CHECK(moved(true) == moved(false));
}

TEST_CASE("F7: steps that do not advance time are refused") {
  auto s = simulation();
  CHECK_REFUSED(s.run(0.01, {.max_step = 1e-25}), "never reach", "0.01");
  CHECK_REFUSED(s.run(0.01, {.cfl = 1e-300}), "never reach");
  CHECK_REFUSED(s.run(1e300), "never reach");
}

TEST_CASE("F9: observers add observers") {
  auto s = simulation();
  int outer = 0, inner = 0;
  s.observe(0, [&](double) {
    ++outer;
    for (int k = 0; k < 10; ++k) s.observe(0, [&](double) { ++inner; });
  });
  const auto result = s.run(1, {.progress = [](std::int64_t steps, double, double) { return steps < 5; }});
  CHECK(result.steps == 5);
  CHECK(outer == 6);
  CHECK(inner == 10 * (6 + 5 + 4 + 3 + 2 + 1));
}

TEST_CASE("F9, F20: a simulation that runs is not set up, run or relaxed from inside") {
  const auto all_refused = [](Simulation<2>& s, const char* during) {
    CHECK_REFUSED(s.run(1e-3), "run: not while", during);
    CHECK_REFUSED(s.relax(), "relax: not while", during);
    CHECK_REFUSED(s.check_run(1e-3), "run: not while", during);
    CHECK_REFUSED(s.check_relax(), "relax: not while", during);
    CHECK_REFUSED(s.prepare(), "prepare: not while", during);
    CHECK_REFUSED(s.load(everywhere(), {1, 0}), "load: not while", during);
    CHECK_REFUSED(s.clamp(everywhere()), "clamp: not while", during);
    CHECK_REFUSED(s.body_force({1, 0}), "body_force: not while", during);
    CHECK_REFUSED(s.symmetry_plane(0, 0), "symmetry_plane: not while", during);
    CHECK_REFUSED(s.set_velocity([](const Vec<2>&) { return Vec<2>(0, 0); }), "set_velocity: not while",
                  during);
    CHECK_REFUSED(s.set_material(everywhere(), material()), "set_material: not while", during);
    CHECK(std::isfinite(s.displacement(3)[0]));
    CHECK(s.size() == 66);
  };
  auto s = simulation();
  int seen = 0;
  bool in_setup = false;
  s.set_displacement([&](const Vec<2>&) {
    if (!in_setup) all_refused(s, "prepare");
    in_setup = true;
    return Vec<2>(0, 0);
  });
  s.observe(0, [&](double) {
    if (++seen == 2) all_refused(s, "run");
  });
  const auto progress = [&](const char* during) {
    return [&all_refused, &s, during](std::int64_t steps, double, double) {
      if (steps == 3 || steps == 32) all_refused(s, during);
      return steps < 40;
    };
  };
  CHECK(s.run(1, {.progress = progress("run")}).steps == 40);
  CHECK(in_setup);
  CHECK(seen == 41);
  CHECK(s.relax({.max_steps = 64, .progress = progress("relax")}).steps > 0);
  CHECK(s.run(1e-3).status == Status::ok);  // over, and open again
}

TEST_CASE("F9: what an observer throws comes out, and the simulation goes on") {
  auto s = simulation();
  int seen = 0;
  s.observe(0, [&](double) {
    if (++seen == 5) throw Boom();
  });
  CHECK_THROWS_AS(s.run(1e-2), Boom);
  const double reached = s.time();
  CHECK(reached > 0);
  CHECK(s.run(1e-2).status == Status::ok);
  CHECK(s.time() == doctest::Approx(reached + 1e-2));
}

TEST_CASE("F9: simulations move, and one that has been moved from says so") {
  static_assert(std::is_nothrow_move_constructible_v<Simulation<3>>);
  static_assert(std::is_nothrow_move_assignable_v<Simulation<3>>);
  static_assert(!std::is_copy_constructible_v<Simulation<3>> && !std::is_copy_assignable_v<Simulation<3>>);
  auto s = simulation();
  s.set_velocity([](const Vec<2>& X) { return Vec<2>(X[0], 0); });
  s.run(1e-3);
  const Vec<2> u = s.displacement(10);
  std::vector<Simulation<2>> many;
  many.push_back(std::move(s));
  many.push_back(simulation());
  CHECK(many[0].displacement(10) == u);
  const StressRecovery<2> recovery(many[0]);
  many.erase(many.begin() + 1);
  const Simulation<2>& from = s;  // NOLINT: what was moved from is what this is about
  const std::vector<std::function<void()>> calls = {
      [&] { s.face("x_min"); },
      [&] { s.set_material(everywhere(), material()); },
      [&] { s.set_velocity([](const Vec<2>&) { return Vec<2>(0, 0); }); },
      [&] { s.set_displacement([](const Vec<2>&) { return Vec<2>(0, 0); }); },
      [&] { s.clamp(everywhere()); },
      [&] { s.roller(everywhere(), 0); },
      [&] { s.prescribe(everywhere(), 0, [](const Vec<2>&, double) { return 0.0; }); },
      [&] {
        s.load(everywhere(), {1, 0});
      },
      [&] {
        s.body_force({1, 0});
      },
      [&] { s.symmetry_plane(0, 0); },
      [&] { s.prepare(); },
      [&] { s.run(1); },
      [&] { s.relax(); },
      [&] { s.check_run(1); },
      [&] { s.check_relax(); },
      [&] { s.observe(0, [](double) {}); },
      [&] { from.size(); },
      [&] { from.dx(); },
      [&] { from.time(); },
      [&] { from.reference_position(0); },
      [&] { from.position(0); },
      [&] { from.displacement(0); },
      [&] { from.velocity(0); },
      [&] { from.cauchy_stress(0); },
      [&] { from.full_cauchy_stress(0); },
      [&] { from.first_piola_kirchhoff(0); },
      [&] { from.deformation_gradient(0); },
      [&] { from.mass(0); },
      [&] {
        from.displacement_at({0, 0});
      },
      [&] { from.displacements_at({}); },
      [&] { read_field(from, "mass"); },
      [&] { s.periodic(0, 0, 1); },
      [&] { from.kinetic_energy(); },
      [&] { from.strain_energy(); },
      [&] { from.linear_momentum(); },
      [&] { from.pairs(); },
      [&] { from.bytes(); },
      [&] { from.setup_seconds(); },
      [&] { from.health(); },
      [&] { from.method(); },
      [&] { StressRecovery<2> none(from); },
      [&] { write_vtkhdf("moved_from.vtkhdf", from); },
  };
  for (std::size_t k = 0; k < calls.size(); ++k) {
    CAPTURE(k);
    const std::string message = refusal(calls[k]);
    CHECK(message.find("moved from") != std::string::npos);
  }
  s = std::move(many[0]);
  CHECK(s.displacement(10) == u);
  CHECK(recovery.cauchy_stress().size() == s.size());
}

TEST_CASE("F9: a simulation that is moved or replaced while it runs finishes its run") {
  auto s = simulation();
  Simulation<2> other = simulation();
  int seen = 0;
  s.observe(0, [&](double) {
    if (++seen == 3) other = std::move(s);
    if (seen == 5) other = simulation();  // nobody holds the body that runs
  });
  const auto result = s.run(1, {.progress = [](std::int64_t steps, double, double) { return steps < 10; }});
  CHECK(result.steps == 10);
  CHECK(seen == 11);
  CHECK_REFUSED(s.size(), "moved from");
  CHECK(other.time() == 0);
}

TEST_CASE("F9, F15: a cloud is looked at in full") {
  const auto damaged = [](Lattice lattice, const std::function<void(Cloud<2>&)>& damage,
                          const char* formulation = "tl_displacement") {
    Cloud<2> cloud = sheet(lattice);
    damage(cloud);
    const Method method{.formulation = formulation,
                        .operators = lattice == Lattice::cell_centred ? "compatible" : ""};
    Simulation<2> s(cloud, material(), method);
  };
  const auto node = Lattice::node_centred, cell = Lattice::cell_centred;
  CHECK_REFUSED(damaged(node, [](auto& c) { c.extra.assign(3, 0); }), "66 positions", "3 marks");
  CHECK_REFUSED(damaged(node, [](auto& c) { c.X[5][1] = infinity; }), "particle 5", "its y is inf");
  CHECK_REFUSED(damaged(node, [](auto& c) { c.V[5] = -1; }), "particle 5", "volume -1");
  CHECK_REFUSED(damaged(node, [](auto& c) { c.B[7][0] = not_a_number; }), "area vector of particle 7",
                "finite");
  CHECK_REFUSED(damaged(node, [](auto& c) { c.spacing.assign(66, 0.1), c.spacing[9] = 0; }), "particle 9",
                "spacings");
  CHECK_REFUSED(damaged(node, [](auto& c) { c.origin[0] = not_a_number; }), "origin", "finite");
  CHECK_REFUSED(damaged(node, [](auto& c) { c.body_volume = not_a_number; }), "body_volume");
  CHECK_REFUSED(damaged(
                    node, [](auto& c) { c.cells[4][1] = 66; }, "tl_stress_points"),
                "corner 66 of cell 4");
  CHECK_REFUSED(damaged(
                    node, [](auto& c) { c.cells[4][1] = c.cells[4][0]; }, "tl_stress_points"),
                "cell 4", "two of its corners");
  for (const double share : {-1.0, 1.5, not_a_number})
    CHECK_REFUSED(damaged(
                      node,
                      [&](auto& c) {
                        c.cell_share.assign(c.cells.size(), 1.0);
                        c.cell_share[2] = share;
                      },
                      "tl_stress_points"),
                  "share of cell 2", "0 … 1");
  CHECK_REFUSED(damaged(
                    node, [](auto& c) { c.cell_share.assign(c.cells.size(), 0.0); }, "tl_stress_points"),
                "no cell");
  CHECK_REFUSED(damaged(
                    node, [](auto& c) { c.cell_share.assign(3, 1.0); }, "tl_stress_points"),
                "3 shares");
  CHECK_REFUSED(damaged(cell, [](auto& c) { c.facets[3].owner = -1; }), "owner -1");
  CHECK_REFUSED(damaged(cell, [](auto& c) { c.facets[3].area[0] = not_a_number; }), "area vector of facet 3");
  CHECK_REFUSED(damaged(cell, [](auto& c) { c.facets[3].centre[1] = infinity; }), "centre of facet 3");
}

TEST_CASE("F20: a body whose spacing is lost in the digits of its coordinates is refused") {
  const auto body = [](double at) {
    return Simulation<2>(make_cloud(box<2>({at, 0}, {at + 1, 1}), {.dx = 0.0125}), material(), {});
  };
  CHECK_REFUSED(body(1e12), "1e+12 m from the origin", "102", "1000", "0.000122");
  body(1e9).prepare();
  Cloud<2> far = sheet();
  for (auto& X : far.X) X[0] += 1e15;
  CHECK_REFUSED(Simulation<2>(far, material(), {}), "from the origin", "resolution");
}

TEST_CASE("F20: ids that no particle has") {
  auto s = simulation();
  for (int round = 0; round < 2; ++round) {
    for (const std::size_t id : {std::size_t{66}, static_cast<std::size_t>(-1)}) {
      CHECK_REFUSED(s.reference_position(id), "is none of the 66");
      CHECK_REFUSED(s.position(id), "is none of the 66");
      CHECK_REFUSED(s.displacement(id), "is none of the 66");
      CHECK_REFUSED(s.mass(id), "is none of the 66");
      if (round == 0) continue;
      CHECK_REFUSED(s.velocity(id), "is none of the 66");
      CHECK_REFUSED(s.cauchy_stress(id), "is none of the 66");
      CHECK_REFUSED(s.full_cauchy_stress(id), "is none of the 66");
      CHECK_REFUSED(s.first_piola_kirchhoff(id), "is none of the 66");
      CHECK_REFUSED(s.deformation_gradient(id), "is none of the 66");
    }
    s.prepare();
  }
  CHECK_REFUSED(s.displacement_at({not_a_number, 0}), "displacement_at");
}

TEST_CASE("F20: empty functions") {
  auto s = simulation();
  CHECK_REFUSED(s.set_material({}, material()), "set_material", "empty function");
  CHECK_REFUSED(s.clamp({}), "clamp", "empty function");
  CHECK_REFUSED(s.roller({}, 0), "roller", "empty function");
  CHECK_REFUSED(s.prescribe({}, 0, [](const Vec<2>&, double) { return 0.0; }), "prescribe", "empty function");
  CHECK_REFUSED(s.prescribe(everywhere(), 0, PointHistory<2>()), "prescribe", "empty function");
  CHECK_REFUSED(s.prescribe(everywhere(), 0, History()), "prescribe", "empty function");
  CHECK_REFUSED(s.load({}, {1, 0}), "load", "empty function");
  CHECK_REFUSED(s.set_velocity({}), "set_velocity", "empty function");
  CHECK_REFUSED(s.set_displacement({}), "set_displacement", "empty function");
  CHECK_REFUSED(s.observe(0, {}), "observe", "empty function");
  CHECK_REFUSED(Shape<2>({}, {0, 0}, {1, 1}), "empty");
  CHECK_REFUSED(implicit<2>({}, {0, 0}, {1, 1}), "empty");
  s.load(everywhere(), {1, 0}, {});  // a history that is none is 1
  CHECK(s.run(1e-3).status == Status::ok);
}

TEST_CASE("F20: options and choices out of range") {
  auto s = simulation();
  for (const double value : {-1.0, not_a_number, infinity}) {
    CHECK_REFUSED(s.run(1e-3, {.max_step = value}), "max_step");
    CHECK_REFUSED(s.relax({.ramp_time = value}), "ramp_time");
    CHECK_REFUSED(s.relax({.free_time = value}), "free_time");
    CHECK_REFUSED(s.observe(value, [](double) {}), "observe", "interval");
    Method method;
    method.artificial_stress = value;
    CHECK_REFUSED(simulation(method), "artificial_stress", "negative");
  }
  for (const double cfl : {1.0001, 100.0}) {
    CHECK_REFUSED(s.run(1e-3, {.cfl = cfl}), "cfl", "stable", "1 at most");
    CHECK_REFUSED(s.relax({.cfl = cfl}), "cfl", "1 at most");
  }
  CHECK_REFUSED(s.run(1e-3, {.cfl = infinity}), "cfl");
  CHECK_REFUSED(s.run(1e-3, {.cfl = infinity, .max_step = 1e-5}), "cfl");
  CHECK_REFUSED(s.relax({.tolerance = infinity}), "tolerance");
  CHECK_REFUSED(s.relax({.max_steps = -1}), "max_steps");
  CHECK(s.time() == 0);

  const auto with = [](const std::function<void(Method&)>& change) {
    Method method;
    change(method);
    simulation(method);
  };
  for (const int iterations : {-1, 2000000000})
    CHECK_REFUSED(with([&](auto& m) { m.compatible_iterations = iterations; }), "compatible_iterations",
                  "0 to");
  CHECK_REFUSED(with([](auto& m) { m.pair_precision = static_cast<PairPrecision>(77); }), "77", "single",
                "recomputed");
  CHECK_REFUSED(with([](auto& m) { m.skin = 1e6; }), "skin", "at most");
  CHECK_REFUSED(with([](auto& m) { m.velocity_gradient = "exact"; }), "velocity_gradient \"exact\"",
                "standard, corrected");
  CHECK_REFUSED(with([](auto& m) { m.artificial_stress_weight = "linear"; }), "\"linear\"",
                "kernel, distance");
  for (const double exponent : {0.0, 2.5, not_a_number, 1e300})
    CHECK_REFUSED(with([&](auto& m) { m.artificial_stress_exponent = exponent; }),
                  "whole number from 1 to 16");
  MaterialParameters odd = rubber;
  odd.plane = static_cast<Plane>(42);
  CHECK_REFUSED(make_material<2>("neo_hookean", odd), "plane", "42", "strain, stress");
}

TEST_CASE("F20: symmetry planes are given once, and are somewhere") {
  auto s = simulation();
  s.symmetry_plane(0, 0);
  s.symmetry_plane(0, 1);  // the other side is another plane
  CHECK_REFUSED(s.symmetry_plane(0, 0), "symmetry_plane", "already");
  CHECK_REFUSED(s.symmetry_plane(0, 1e-9), "symmetry_plane", "already");
  CHECK_REFUSED(s.symmetry_plane(1, not_a_number), "symmetry_plane", "no place");
  s.symmetry_plane(1, 0);
  CHECK(s.run(1e-3).status == Status::ok);
}

TEST_CASE("F20: files that cannot be read") {
  for (const char* file : {"/proc/self/mem", "/", "/no/such/file"}) {
    CAPTURE(file);
    CHECK_REFUSED(read_cloud<2>(file), file, "cannot be");
  }
}

TEST_CASE("F15: a body that is torn to pieces in its only step is no result") {
  auto s = simulation({.formulation = "tl_displacement"});
  s.set_velocity([](const Vec<2>& X) { return Vec<2>(1e6 * X[0], 0); });
  const auto torn = s.run(1e-3);
  CHECK(torn.steps < 32);
  CHECK(torn.status == Status::broke);
  auto flying = simulation({.formulation = "tl_displacement"});
  flying.set_velocity([](const Vec<2>&) { return Vec<2>(1e6, 0); });
  CHECK(flying.run(1e-3).status == Status::ok);
}

TEST_CASE("F6: materials whose wave speed is no number") {
  class Odd final : public Hyperelastic<2> {
   public:
    explicit Odd(double speed) : Hyperelastic<2>(rubber), speed_(speed) {}
    std::string_view name() const override { return "odd"; }
    double wave_speed(double, double, double, double) const override { return speed_; }
    void stress(const StressBlock<2>& block) const override {
      for (int c = 0; c < 4; ++c)
        std::fill_n(block.P + static_cast<std::size_t>(c) * block.stride, block.n, 0.0);
    }

   private:
    double speed_;
  };
  for (const double speed : {infinity, not_a_number, 0.0, -5.0}) {
    CAPTURE(speed);
    Simulation<2> s(sheet(), std::make_shared<const Odd>(speed), {.formulation = "tl_displacement"});
    s.set_velocity([](const Vec<2>& X) { return Vec<2>(X[0], 0); });
    CHECK_REFUSED(s.run(1e-3), "wave speed", "odd");
  }
}
