// The same bits for one thread and two: bodies are larger than what is left to one thread.
#include <doctest/doctest.h>
#include <omp.h>

#include <cstring>
#include <taut/particles/material_groups.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D, class Run>
std::vector<Vec<D>> positions(int threads, const Cloud<D>& cloud, const char* material, const Method& method,
                              Run&& run) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  int used = 0;
#pragma omp parallel
#pragma omp single
  used = omp_get_num_threads();
  REQUIRE(used == threads);
  Simulation<D> s(cloud, make_material<D>(material, {.E = 1e6, .nu = 0.3, .density = 1000}), method);
  s.clamp(s.face("x_min"));
  s.set_displacement([](const Vec<D>& X) { return Vec<D>(X[0] * wavy<D>(X, 0.01)); });
  s.load(s.face("x_max"), Vec<D>::Constant(1e3));
  run(s);
  std::vector<Vec<D>> x;
  for (std::size_t i = 0; i < s.size(); ++i) x.push_back(s.position(i));
  omp_set_num_threads(before);
  return x;
}

template <int D, class Run>
void same_bits(const Cloud<D>& cloud, const char* material, const Method& method, Run&& run) {
  CAPTURE(method.formulation);
  const auto one = positions<D>(1, cloud, material, method, run),
             two = positions<D>(2, cloud, material, method, run);
  REQUIRE(one.size() == two.size());
  CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Vec<D>)) == 0);
}

}  // namespace

TEST_CASE_TEMPLATE("one thread and two give the same bits", Dimension, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto lattice = brick<D>(D == 2 ? 65 : 16), jittered = brick<D>(D == 2 ? 65 : 16, 0.15);
  REQUIRE(static_cast<Index>(lattice.size()) > parallel_from);
  const auto fifty_steps = [](Simulation<D>& s) {
    const auto result = s.run(1e9, {.progress = [](std::int64_t step, double, double) { return step < 50; }});
    CHECK(result.status == Status::ok);
    CHECK(result.steps == 50);
  };
  same_bits<D>(jittered, "neo_hookean", {.neighbours = "kd_tree", .zero_energy_control = 0.1}, fifty_steps);
  same_bits<D>(jittered, "neo_hookean", {.formulation = "tl_bond_associated"}, fifty_steps);
  if (D == 2)
    same_bits<D>(lattice, "hypoelastic",
                 {.formulation = "ul_basic", .support_dx = 2.4, .viscosity = 0.5, .skin = 0}, fifty_steps);
  else
    same_bits<D>(lattice, "hypoelastic",
                 {.formulation = "ul_artificial_stress", .support_dx = 1.8, .velocity_gradient = "corrected"},
                 fifty_steps);
}

TEST_CASE("one thread and two relax with the same bits") {
  // Large enough for the loops over flat arrays to be shared as well.
  const auto cloud = brick<3>(24);
  REQUIRE(cloud.size() * 3 > 65536);
  same_bits<3>(cloud, "neo_hookean", {}, [](Simulation<3>& s) { s.relax({.max_steps = 10}); });
}
