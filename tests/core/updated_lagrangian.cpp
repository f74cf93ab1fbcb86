// The updated Lagrangian forms where they work: small vibrations, and compression.
#include <doctest/doctest.h>

#include <numbers>

#include "discretised.hpp"

using namespace taut;

namespace {

enum class Sides { free, symmetric };

struct Vibration {
  double frequency_error;  // relative
  double momentum_drift;   // along the bar, over the amount of the motion
};

// Lowest longitudinal mode of a free bar of unit length, from rest in its middle position.
template <int D>
Vibration vibrate(int n, int rows, double nu, Sides sides, const Method& method) {
  const double dx = 1.0 / n, amplitude = 1e-4;
  Vec<D> max = Vec<D>::Constant(rows * dx);
  max[0] = 1;
  const MaterialParameters m{
      .E = 1e6, .nu = nu, .density = 1000, .plane = sides == Sides::free ? Plane::stress : Plane::strain};
  Simulation<D> s(make_cloud(box<D>(Vec<D>::Zero(), max), {.dx = dx, .lattice = Lattice::cell_centred}),
                  make_material<D>("hypoelastic", m), method);
  if (sides == Sides::symmetric)
    for (int d = 1; d < D; ++d) {
      s.symmetry_plane(d, 0);
      s.symmetry_plane(d, max[d]);
    }
  const bool strain = D == 1 || sides == Sides::symmetric;
  const double c = std::sqrt((strain ? m.lambda() + 2 * m.mu() : m.E) / m.density);
  const auto shape = [](const Vec<D>& X) { return std::cos(std::numbers::pi * X[0]); };
  s.set_velocity([&](const Vec<D>& X) {
    Vec<D> v = Vec<D>::Zero();
    v[0] = amplitude * c * shape(X);
    return v;
  });
  // Times at which the mode passes through rest, by its share of the velocity.
  std::vector<double> turns;
  double before = 0, then = 0, amount = 0;
  s.prepare();
  for (std::size_t i = 0; i < s.size(); ++i) amount += s.mass(i) * s.velocity(i).norm();
  const Vec<D> momentum = s.linear_momentum();
  s.observe(0, [&](double t) {
    double share = 0;
    for (std::size_t i = 0; i < s.size(); ++i)
      share += s.mass(i) * s.velocity(i)[0] * shape(s.reference_position(i));
    if (t > 0 && share * before < 0) turns.push_back(then + (t - then) * before / (before - share));
    before = share;
    then = t;
  });
  CHECK(s.run(1.6 * 2 / c).status == Status::ok);
  REQUIRE(turns.size() >= 3);
  const double period = 2 * (turns.back() - turns.front()) / static_cast<double>(turns.size() - 1);
  return {2 / c / period - 1, std::abs((s.linear_momentum() - momentum)[0]) / amount};
}

Method of(const char* formulation, const char* gradient = "standard") {
  return {.formulation = formulation, .kernel = "sinc5", .support_dx = 2.4, .velocity_gradient = gradient};
}

}  // namespace

TEST_CASE("updated Lagrangian: a bar of one-dimensional strain has its frequency") {
  for (const char* formulation : {"ul_basic", "ul_artificial_stress"})
    for (const char* gradient : {"standard", "corrected"}) {
      CAPTURE(formulation);
      CAPTURE(gradient);
      const Method method = of(formulation, gradient);
      // Artificial stress softens what is in tension, however little: 0.3 f^4 of the stress of nearest
      // neighbours.
      const double tolerance = method.formulation == "ul_basic" ? 0.02 : 0.1;
      const auto one = vibrate<1>(50, 1, 0.3, Sides::symmetric, method);
      const auto two = vibrate<2>(40, 5, 0.3, Sides::symmetric, method);
      const auto three = vibrate<3>(24, 3, 0.3, Sides::symmetric, method);
      for (const Vibration& v : {one, two, three}) {
        CHECK(std::abs(v.frequency_error) < tolerance);
        CHECK(v.momentum_drift < 1e-13);
      }
    }
}

TEST_CASE("updated Lagrangian: a free strip has the frequency of a bar") {
  // The plain gradients miss part of the free sides' particles, and the strip is softer by as much as these
  // count.
  for (const double nu : {0.0, 0.3}) {
    const auto v = vibrate<2>(50, 10, nu, Sides::free, of("ul_basic", "corrected"));
    CHECK(std::abs(v.frequency_error) < 0.03);
    CHECK(v.momentum_drift < 1e-13);
  }
  const double coarse = vibrate<2>(40, 8, 0, Sides::free, of("ul_basic")).frequency_error;
  const double fine = vibrate<2>(80, 16, 0, Sides::free, of("ul_basic")).frequency_error;
  CHECK(std::abs(fine) < 0.03);
  CHECK(std::abs(fine) < 0.7 * std::abs(coarse));
}

TEST_CASE_TEMPLATE("updated Lagrangian: artificial stress is silent in compression and not in tension",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto end = [](const char* formulation, double direction) {
    const double dx = 0.05;
    Vec<D> max = Vec<D>::Constant(3 * dx);
    max[0] = 1;
    Simulation<D> s(make_cloud(box<D>(Vec<D>::Zero(), max), {.dx = dx, .lattice = Lattice::cell_centred}),
                    make_material<D>("hypoelastic", {.E = 1e6, .nu = 0.3, .density = 1000}), of(formulation));
    for (int d = 0; d < D; ++d) s.symmetry_plane(d, 0);
    for (int d = 1; d < D; ++d) s.symmetry_plane(d, max[d]);
    // Slowly against the wave's 27 ms, along with the uniform motion, so that no wave changes the sign
    // anywhere.
    s.set_velocity([=](const Vec<D>& X) {
      Vec<D> v = Vec<D>::Zero();
      v[0] = direction * X[0];
      return v;
    });
    s.prescribe([](const Vec<D>& X) { return X[0] > 0.85; }, 0,
                [=](const Vec<D>& X, double t) { return direction * X[0] * t; });
    CHECK(s.run(0.05).status == Status::ok);
    std::vector<Vec<D>> x;
    bool silent = true;
    for (std::size_t i = 0; i < s.size(); ++i) {
      x.push_back(s.position(i));
      silent = silent && (direction * s.cauchy_stress(i)(0, 0)) > 0;
    }
    CHECK(silent);
    return x;
  };
  const auto difference = [&](double direction) {
    const auto plain = end("ul_basic", direction), artificial = end("ul_artificial_stress", direction);
    double largest = 0;
    for (std::size_t i = 0; i < plain.size(); ++i)
      largest = std::max(largest, (plain[i] - artificial[i]).norm());
    return largest;
  };
  CHECK(difference(-1) < 1e-15);
  CHECK(difference(1) > 1e-4);
}
