// Pairwise control of zero-energy modes: silent in what the gradients see, stiff against what they do not,
// and derived from an energy.
#include <doctest/doctest.h>

#include "discretised.hpp"

using namespace taut;

namespace {

constexpr double E = 1e6;

template <int D>
std::shared_ptr<const Material<D>> rubber() {
  return make_material<D>("neo_hookean", {.E = E, .nu = 0.3, .density = 1000});
}

// Forces with the control less those without.
template <int D, class F>
std::vector<Vec<D>> control_forces(const Cloud<D>& cloud, const Method& method, F&& position) {
  Method without = method;
  without.zero_energy_control = 0;
  Bare<D> a(cloud, rubber<D>(), method), b(cloud, rubber<D>(), without);
  a.place(position);
  b.place(position);
  auto forces = a.forces();
  const auto plain = b.forces();
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] -= plain[i];
  return forces;
}

template <int D>
double largest(const std::vector<Vec<D>>& forces) {
  double value = 0;
  for (const auto& f : forces) value = std::max(value, f.norm());
  return value;
}

// Operators that are linearly exact, with the smallest support that all clouds here allow.
constexpr std::pair<const char*, double> linear_operators[] = {
    {"corrected", 1.5}, {"corrected", 2.4}, {"compatible", 1.5}, {"antisymmetric", 1.5}, {"quadratic", 2.6}};

}  // namespace

TEST_CASE_TEMPLATE("zero-energy control: no force where the motion is linear", Dimension, Dim<1>, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 1 ? 40 : D == 2 ? 10 : 5, 0.15);
  Mat<3> A3;
  A3 << 1.3, 0.4, -0.2, -0.1, 0.8, 0.3, 0.25, -0.15, 1.1;
  const Mat<D> A = A3.topLeftCorner<D, D>();
  for (const auto& [operators, support] : linear_operators) {
    CAPTURE(operators);
    const auto forces =
        control_forces<D>(cloud, {.operators = operators, .support_dx = support, .zero_energy_control = 1},
                          [&](const Vec<D>& X) { return Vec<D>(A * X); });
    CHECK(largest<D>(forces) < 1e-12 * E * std::pow(cloud.dx, D - 1));
  }
}

TEST_CASE_TEMPLATE("zero-energy control: forces are minus the derivative of the energy", Dimension, Dim<1>,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 1 ? 30 : 6, 0.15);
  const auto check = [&](const char* operators, double support) {
    CAPTURE(operators);
    Bare<D> body(cloud, rubber<D>(),
                 {.operators = operators, .support_dx = support, .zero_energy_control = 3});
    // The shorter wave is what the gradients see little of.
    body.place([&](const Vec<D>& X) {
      return Vec<D>(X + wavy<D>(X, 0.05) + wavy<D>(Vec<D>(2.5 / cloud.dx * X), 0.02 * cloud.dx));
    });
    check_derivative(body, cloud.dx, D == 3 ? 37 : 3);
  };
  check("standard", 1.5);
  for (const auto& [operators, support] : linear_operators) check(operators, support);
}

TEST_CASE_TEMPLATE("zero-energy control: the energy does not change when the body turns", Dimension, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 2 ? 10 : 5, 0.15);
  for (const auto& [operators, support] : linear_operators) {
    CAPTURE(operators);
    const Method without{.operators = operators, .support_dx = support};
    Method with = without;
    with.zero_energy_control = 1;
    double energies[2];
    for (int turned = 0; turned < 2; ++turned) {
      const Mat<D> R = rotation<D>(turned ? 2.5 : 0.0);
      Bare<D> a(cloud, rubber<D>(), with), b(cloud, rubber<D>(), without);
      for (Bare<D>* body : {&a, &b})
        body->place([&](const Vec<D>& X) {
          return Vec<D>(R * (X + wavy<D>(Vec<D>(2.5 / cloud.dx * X), 0.02 * cloud.dx)));
        });
      energies[turned] = a.formulation->strain_energy() - b.formulation->strain_energy();
    }
    CHECK(energies[0] > 0);
    CHECK(energies[1] == doctest::Approx(energies[0]).epsilon(1e-9));
  }
}

TEST_CASE_TEMPLATE("zero-energy control: internal forces and moments cancel", Dimension, Dim<1>, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 1 ? 40 : D == 2 ? 10 : 5, 0.15);
  for (const auto& [operators, support] : linear_operators) {
    CAPTURE(operators);
    Bare<D> body(cloud, rubber<D>(),
                 {.operators = operators, .support_dx = support, .zero_energy_control = 1});
    body.place([](const Vec<D>& X) { return Vec<D>(X + wavy<D>(X, 0.1) + wavy<D>(Vec<D>(29 * X), 0.01)); });
    check_balance(body);
  }
}

TEST_CASE_TEMPLATE("zero-energy control: the zig-zag mode is free without it and pulled back with it",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 1 ? 40 : D == 2 ? 12 : 8);
  const double amplitude = 1e-3 * cloud.dx;
  // At R = 1.5 dx central differences see none of a field that changes sign from particle to particle.
  const auto sign = [&](const Vec<D>& X) {
    long parity = 0;
    for (int d = 0; d < D; ++d) parity += std::lround(X[d] / cloud.dx);
    return parity % 2 ? -1.0 : 1.0;
  };
  const auto zigzag = [&](const Vec<D>& X) {
    Vec<D> x = X;
    x[0] += amplitude * sign(X);
    return x;
  };
  const auto inside = [&](const Vec<D>& X) {
    Vec<D> max = Vec<D>::Ones();
    max[0] = 1.5;
    return std::min(X.minCoeff(), (max - X).minCoeff()) > 2.5 * cloud.dx;
  };
  const double scale = E * std::pow(cloud.dx, D - 1) * amplitude / cloud.dx, alpha = 0.1;
  Bare<D> free(cloud, rubber<D>(), {}), held(cloud, rubber<D>(), {.zero_energy_control = alpha});
  // The nearest neighbours, two along each axis, are 2 A out of place; the others have the same sign.
  const Kernel kernel("wendland_c2", D);
  const double W = kernel.value(cloud.dx, 1.5 * cloud.dx / kernel.radius_factor());
  const double expected = 4 * D * alpha * E * std::pow(cloud.dx, 2 * D - 2) * W * amplitude;
  free.place(zigzag);
  held.place(zigzag);
  const auto without = free.forces(), with = held.forces();
  int checked = 0;
  for (Index i = 0; i < free.n(); ++i) {
    if (!inside(free.X(i))) continue;
    ++checked;
    const auto k = static_cast<std::size_t>(i);
    CHECK(without[k].norm() < 1e-9 * scale);
    CHECK(-with[k][0] * sign(free.X(i)) == doctest::Approx(expected).epsilon(1e-4));
  }
  CHECK(checked > 5);
}

TEST_CASE_TEMPLATE("zero-energy control: the energy of a free vibration stays over 10000 steps", Dimension,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  Simulation<D> s(brick<D>(D == 2 ? 8 : 4, 0.15), rubber<D>(), {.zero_energy_control = 1});
  s.set_displacement([](const Vec<D>& X) { return wavy<D>(X, 0.02); });
  s.run(0);
  // The energy of single instants moves by (omega dt)^2 / 4 of the part of the shortest waves, to and fro.
  double first = 0, last = 0;
  const auto result = s.run(1e9, {.cfl = 0.2, .progress = [&](std::int64_t step, double, double) {
                                    const double now = s.kinetic_energy() + s.strain_energy();
                                    if (step <= 1000) first += now / 1000;
                                    if (step > 9000) last += now / 1000;
                                    return step < 10000;
                                  }});
  CHECK(result.status == Status::ok);
  CHECK(last == doctest::Approx(first).epsilon(1e-3));
}

TEST_CASE_TEMPLATE("zero-energy control: the stable step knows of it", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 1 ? 40 : D == 2 ? 8 : 5, 0.15);
  for (const auto& [operators, support] : linear_operators)
    for (const double control : {1.0, 100.0}) {
      CAPTURE(operators);
      CAPTURE(control);
      check_stable_step(cloud, rubber<D>(),
                        {.operators = operators, .support_dx = support, .zero_energy_control = control});
    }
}

TEST_CASE("zero-energy control: a jittered cantilever comes to rest, however stiff the control") {
  for (const auto& [operators, support] : linear_operators)
    for (const double control : {0.1, 1.0, 10.0}) {
      CAPTURE(operators);
      CAPTURE(control);
      Simulation<2> beam(make_cloud(box<2>({0, 0}, {0.2, 0.02}), {.dx = 4e-3, .jitter = 0.15}),
                         make_material<2>("st_venant_kirchhoff",
                                          {.E = 20e6, .nu = 0, .density = 1000, .plane = Plane::stress}),
                         {.operators = operators, .support_dx = support, .zero_energy_control = control});
      beam.clamp(beam.face("x_min"));
      beam.load(beam.face("x_max"), {0, -250});
      const auto result = beam.relax({.max_steps = 100000});
      CHECK(result.status == Status::ok);
    }
}
