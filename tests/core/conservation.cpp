// What a free body keeps over ten thousand steps.
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "discretised.hpp"

using namespace taut;

namespace {

// Strains of some per cent and a flight of the whole body, without constraints, loads or damping.
template <int D>
void fly(Simulation<D>& s) {
  s.set_displacement([](const Vec<D>& X) { return wavy<D>(X, 0.02); });
  s.set_velocity([](const Vec<D>& X) { return Vec<D>(wavy<D>(Vec<D>(2 * X), 0.5) + Vec<D>::Constant(1)); });
  s.run(0);
}

}  // namespace

TEST_CASE_TEMPLATE("a free body keeps both momenta over 10000 steps", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double control : {0.0, 0.1}) {
    CAPTURE(control);
    Simulation<D> s(brick<D>(D == 1   ? 40
                             : D == 2 ? 8
                                      : 4,
                             0.15),
                    make_material<D>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                    {.zero_energy_control = control});
    fly(s);
    double amount = 0;  // of motion: what drifts are relative to
    for (std::size_t i = 0; i < s.size(); ++i) amount += s.mass(i) * s.velocity(i).norm();
    const Vec<D> momentum = s.linear_momentum();
    const Vec<3> angular = angular_momentum<D>(s);
    const auto result =
        s.run(1e9, {.progress = [](std::int64_t step, double, double) { return step < 10000; }});
    CHECK(result.status == Status::ok);
    CHECK(result.steps == 10000);
    CHECK((s.linear_momentum() - momentum).norm() < 1e-13 * amount);
    // P F^T is symmetric with the F that the force is the adjoint of, so the angular momentum stays as well,
    // and leapfrog keeps both exactly.
    CHECK((angular_momentum<D>(s) - angular).norm() < 1e-12 * amount);
  }
}

TEST_CASE_TEMPLATE("the energy of an undamped free body stays over 10000 steps", Dimension, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  // Leapfrog keeps a neighbouring energy whose part of a mode differs by (omega dt)^2 / 4; the highest modes
  // have omega dt = 2 cfl, so that what it does to the true energy is below cfl^2, and grows with the share
  // of those modes. The energy must also fall with the step, and have no trend: steps that followed the
  // vibrations gave +2000 %.
  double deviation[2] = {0, 0};
  const double cfls[2] = {0.6, 0.3};
  for (int k = 0; k < 2; ++k) {
    Simulation<D> s(brick<D>(D == 2 ? 8 : 4, 0.15),
                    make_material<D>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}), {});
    fly(s);
    const double moving = 0.5 * s.linear_momentum().squaredNorm() / (1000 * 1.5);
    const double energy = s.kinetic_energy() + s.strain_energy() - moving;
    double low = energy, high = energy;
    const auto result = s.run(1e9, {.cfl = cfls[k], .progress = [&](std::int64_t step, double, double) {
                                      const double now = s.kinetic_energy() + s.strain_energy() - moving;
                                      low = std::min(low, now);
                                      high = std::max(high, now);
                                      return step < 10000;
                                    }});
    CHECK(result.status == Status::ok);
    deviation[k] = std::max(energy - low, high - energy) / energy;
    CHECK(deviation[k] < 0.5 * cfls[k] * cfls[k]);
  }
  CHECK(deviation[0] > 3 * deviation[1]);
}
