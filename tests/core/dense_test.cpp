// The dense-matrix algorithm 5.2 of the Cape Town thesis (dense_steps.hpp) against the engine with the
// `standard` operator.
#include <doctest/doctest.h>

#include <cmath>
#include <scaling/dense_steps.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/taut.hpp>
#include <vector>

using namespace taut;

namespace {

using Form = bench::DenseSteps<2>::Form;

// Largest difference over the largest displacement, dense against engine, for a smooth bump of initial
// displacement.
double difference(bool held_rim, Form form) {
  constexpr double dx = 0.025, amplitude = 1e-2, support = 2.6;
  constexpr int steps = 60;
  const auto cloud = make_cloud(box<2>({0, 0}, {1, 0.8}), {.dx = dx, .lattice = Lattice::cell_centred});
  const MaterialParameters parameters{.E = 200e9, .nu = 0.3, .density = 8000};
  const Kernel kernel("modified_mollifier", 2);
  const auto held = [&](const Vec<2>& X) {
    const double rim = (support + 0.5) * dx;
    return held_rim && (X[0] < rim || X[0] > 1 - rim || X[1] < rim || X[1] > 0.8 - rim);
  };
  const auto bump = [&](const Vec<2>& X) -> Vec<2> {
    const double width = held_rim ? 0.3 : 0.7, r2 = (X - Vec<2>(0.5, 0.4)).squaredNorm() / (width * width);
    return r2 < 1 ? Vec<2>(amplitude * std::pow(1 - r2, 4), -0.5 * amplitude * std::pow(1 - r2, 4))
                  : Vec<2>(0, 0);
  };
  Simulation<2> simulation(cloud, make_material<2>("neo_hookean", parameters),
                           {.formulation = "tl_displacement",
                            .operators = "standard",
                            .kernel = "modified_mollifier",
                            .support_dx = support,
                            .pair_precision = PairPrecision::double_precision});
  simulation.set_displacement(bump);
  if (held_rim) simulation.clamp(held);
  const double dt = 0.2 * dx / 5801;
  RunOptions options{.integrator = "central_difference", .cfl = 1e3, .max_step = dt};
  CHECK(simulation.run(steps * dt, options).status == Status::ok);

  std::vector<Vec<2>> displacement;
  std::vector<bool> at_rest;
  for (const auto& X : cloud.X) {
    displacement.push_back(bump(X));
    at_rest.push_back(held(X));
  }
  bench::DenseSteps<2> dense(cloud, kernel, support * cloud.dx / kernel.radius_factor(), parameters,
                             displacement, form, at_rest);
  for (int step = 0; step < steps; ++step) dense.step(dt);
  double largest = 0, error = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    largest = std::max(largest, dense.displacement(i).norm());
    error = std::max(error, (dense.displacement(i) - simulation.displacement(i)).norm());
  }
  CHECK(largest > amplitude / 10);
  return error / largest;
}

}  // namespace

TEST_CASE("dense matrices as printed give the engine's displacements within a held rim") {
  CHECK(difference(true, Form::as_printed) < 1e-12);
}

TEST_CASE("dense matrices in conjugate form give the engine's displacements with a free boundary") {
  CHECK(difference(false, Form::conjugate) < 1e-12);
  // The form as printed is another method at a free boundary: were it not, this comparison could not fail.
  CHECK(difference(false, Form::as_printed) > 1e-3);
}
