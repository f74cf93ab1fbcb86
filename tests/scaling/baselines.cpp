// What taut-scaling measures taut against must give taut's answers, or its ratios mean nothing.
#include <doctest/doctest.h>

#include <algorithm>
#include <scaling/baseline.hpp>
#include <scaling/body.hpp>
#include <scaling/engine_step.hpp>
#include <scaling/lists.hpp>
#include <scaling/traffic.hpp>
#include <string>
#include <taut/base/error.hpp>
#include <taut/formulations/auto_method.hpp>

using namespace taut;
using namespace taut::bench;

namespace {

Method method_of(Arrangement arrangement, PairPrecision precision = PairPrecision::double_precision) {
  Method method = with_defaults({});
  method.support_dx = neighbourhood<3>(32, arrangement).support_dx;
  method.pair_precision = precision;
  return method;
}

double difference(const std::vector<Vec<3>>& a, const std::vector<Vec<3>>& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0, error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, a[i].norm());
    error = std::max(error, (a[i] - b[i]).norm());
  }
  REQUIRE(largest > 0);
  return error / largest;
}

}  // namespace

TEST_CASE("baselines have the accelerations of the engine, before steps and after them") {
  for (const Arrangement arrangement : {Arrangement::lattice, Arrangement::jittered}) {
    const Cloud<3> cloud = cube<3>(1000, arrangement);
    const Method method = method_of(arrangement);
    const EngineStep<3> engine(cloud, method);
    const BaselineBody body{
        cloud, method,
        std::dynamic_pointer_cast<const Hyperelastic<3>>(make_material<3>("neo_hookean", step_parameters()))};
    const auto csr = make_csr_gather(body), eigen = make_eigen_sparse(body);
    const std::vector<Vec<3>> start = engine.start_accelerations();
    CHECK(difference(start, csr->accelerations()) < 1e-11);
    CHECK(difference(start, eigen->accelerations()) < 1e-11);
    // One way of stepping, whatever the threads; the state moves on.
    for (int step = 0; step < 20; ++step) {
      csr->step(engine.step(), 1);
      eigen->step(engine.step(), 2);
    }
    CHECK(difference(csr->accelerations(), eigen->accelerations()) < 1e-10);
    CHECK(difference(csr->accelerations(), start) > 1e-2);
  }
}

TEST_CASE("steps of a baseline end where the engine's do") {
  const Cloud<3> cloud = cube<3>(1000, Arrangement::jittered);
  const Method method = method_of(Arrangement::jittered);
  const auto material = make_material<3>("neo_hookean", step_parameters());
  const double dt = 0.5 * EngineStep<3>(cloud, method).step();
  constexpr int steps = 10;
  // Half steps' velocities of the baseline are zero before the first kick, which is a whole one: so is the
  // first of a body that moves with half the kick already.
  Simulation<3> simulation(cloud, material, method);
  const auto csr =
      make_csr_gather({cloud, method, std::dynamic_pointer_cast<const Hyperelastic<3>>(material)});
  const std::vector<Vec<3>> a = csr->accelerations();
  simulation.set_displacement(start_displacement<3>);
  simulation.set_velocity([&](const Vec<3>& X) -> Vec<3> {
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (cloud.X[i] == X) return dt / 2 * a[i];
    return Vec<3>::Zero();
  });
  RunOptions options;
  options.max_step = dt;
  CHECK(simulation.run(steps * dt, options).steps == steps);
  for (int step = 0; step < steps; ++step) csr->step(dt, 1);
  // The engine's accelerations of its last state.
  Simulation<3> last(cloud, material, method);
  last.set_displacement([&](const Vec<3>& X) -> Vec<3> {
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (cloud.X[i] == X) return simulation.displacement(i);
    return Vec<3>::Zero();
  });
  last.run(0);
  std::vector<Vec<3>> expected(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) expected[i] = last.acceleration(i);
  CHECK(difference(expected, csr->accelerations()) < 1e-10);
}

TEST_CASE("single precision changes accelerations by its round-off, the other payloads by that of doubles") {
  const Cloud<3> cloud = cube<3>(1000, Arrangement::lattice);
  const auto accelerations = [&](PairPrecision precision) {
    return EngineStep<3>(cloud, method_of(Arrangement::lattice, precision)).start_accelerations();
  };
  const auto exact = accelerations(PairPrecision::double_precision);
  CHECK(difference(exact, accelerations(PairPrecision::shared)) < 1e-11);
  const double single = difference(exact, accelerations(PairPrecision::single_precision));
  CHECK(single < 1e-5);
  CHECK(single > 1e-10);  // else it was not single
}

TEST_CASE("cubes have the neighbours that their names say") {
  for (const Neighbourhood& hood : neighbourhoods<3>(Arrangement::lattice)) {
    const Cloud<3> cloud = cube<3>(15 * 15 * 15, Arrangement::lattice);
    Method method = with_defaults({});
    method.support_dx = hood.support_dx;
    const auto pairs = [&](double radius) {
      const CompressedPairs p = compressed_pairs(cloud, [&] {
        Method m = with_defaults({});
        m.support_dx = radius;
        return m;
      }());
      std::int64_t most = 0;
      for (std::size_t i = 0; i + 1 < p.row.size(); ++i) most = std::max(most, p.row[i + 1] - p.row[i]);
      return most;
    };
    CHECK(pairs(hood.support_dx) == hood.neighbours);
    CHECK(pairs(hood.support_dx * (1 + hood.skin)) == hood.neighbours);
  }
  CHECK_THROWS_WITH_AS(neighbourhood<3>(19, Arrangement::lattice),
                       "no cube in 3D has particles of 19 neighbours; valid: 18, 32, 56, 80", InputError);
}

TEST_CASE("nanoflann's lists hold the pairs of taut's") {
  for (const std::string& kind : list_clouds()) {
    CAPTURE(kind);
    const ListCloud cloud = list_cloud(kind, 8000);
    const PairList list = taut_list(cloud);
    const SearchedRows theirs = nanoflann_lists(cloud, 2);
    CHECK(pairs_within_own_radius(cloud, list) == theirs.pairs());
    CHECK(theirs.pairs() > 20 * cloud.size());
    if (!cloud.graded()) CHECK(static_cast<std::size_t>(list.pairs()) == theirs.pairs());
  }
  CHECK_THROWS_AS(list_cloud("random", 1000), InputError);
}

TEST_CASE("an updated Lagrangian body rebuilds its list as often as its rate claims") {
  Method method = with_defaults({});
  method.formulation = "ul_basic";
  const Neighbourhood& hood = neighbourhood<3>(32, Arrangement::lattice);
  method.support_dx = hood.support_dx;
  method.skin = hood.skin;
  EngineStep<3> engine(cube<3>(1000, Arrangement::lattice), method);
  CHECK(engine.rate(1, 0) > 0);
  // One step of set-up, one that is not counted, and ten that are.
  CHECK(engine.rebuilds() == 1);
}

TEST_CASE("the least traffic of a step follows its arrays") {
  const Cloud<3> cloud = cube<3>(8000, Arrangement::jittered);
  const Traffic single =
      total_lagrangian_traffic(cloud, method_of(Arrangement::jittered, PairPrecision::single_precision));
  const Traffic twice = total_lagrangian_traffic(cloud, method_of(Arrangement::jittered));
  const Traffic none =
      total_lagrangian_traffic(cloud, method_of(Arrangement::jittered, PairPrecision::recomputed));
  const CompressedPairs p = compressed_pairs(cloud, method_of(Arrangement::jittered));
  const double pairs = static_cast<double>(p.neighbour.size()) / static_cast<double>(cloud.size());
  // Three floats more for each pair and pass, empty lanes besides.
  CHECK(twice.bytes - single.bytes >= 2 * 3 * 4 * pairs);
  CHECK(none.bytes < single.bytes);
  CHECK(twice.flops == single.flops);
  CHECK(none.flops > single.flops);
}
