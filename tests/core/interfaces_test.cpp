// Bodies of several materials: masses are those of the cells, layers are exact, bending converges.
#include <doctest/doctest.h>
#include <omp.h>

#include <cstring>
#include <taut/output/stress_recovery.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

const MaterialParameters soft{.E = 1e6, .nu = 0, .density = 1000, .plane = Plane::stress},
    stiff{.E = 1e8, .nu = 0, .density = 7000, .plane = Plane::stress};

template <int D>
std::shared_ptr<const Material<D>> linear(const MaterialParameters& p) {
  return make_material<D>("linear_elastic", p);
}

/// Displacement of two bars in series, the stiff one held, pulled by 1000 Pa.
double exact(double x) { return x < 0.1 ? 1e-5 * x : 1e-6 + 1e-3 * (x - 0.1); }

template <int D>
Simulation<D> series(const Method& method, const LatticeOptions& lattice) {
  Vec<D> max = Vec<D>::Constant(0.04);
  max[0] = 0.2;
  Simulation<D> s(make_cloud(box<D>(Vec<D>::Zero(), max), lattice), linear<D>(soft), method);
  s.set_material([](const Vec<D>& X) { return X[0] < 0.1 + 1e-9; }, linear<D>(stiff));
  for (int d = 0; d < D; ++d) s.roller(s.face(std::string(1, "xyz"[d]) + "_min"), d);
  s.load(s.face("x_max"), std::pow(0.04, D - 1) * 1000 * Vec<D>::Unit(0));
  return s;
}

/// Checks that the exact displacement is in equilibrium, with the right stress and mass.
template <int D>
void check_series(const Method& method, const LatticeOptions& lattice, double tolerance,
                  double of_forces = 0) {
  CAPTURE(method.formulation);
  CAPTURE(method.operators);
  CAPTURE(lattice.dx);
  CAPTURE(lattice.jitter);
  Simulation<D> s = series<D>(method, lattice);
  s.set_displacement([](const Vec<D>& X) { return Vec<D>(exact(X[0]) * Vec<D>::Unit(0)); });
  s.prepare();
  double stress = 0, recovered = 0, mass = 0, force = 0;
  const auto P = StressRecovery<D>(s).first_piola_kirchhoff();
  for (std::size_t i = 0; i < s.size(); ++i) {
    // Of cells on both sides, the mean.
    const bool between =
        method.formulation == "tl_stress_points" && std::abs(s.reference_position(i)[0] - 0.1) < 1e-6;
    if (!between) stress = std::max(stress, std::abs(s.first_piola_kirchhoff(i)(0, 0) / 1000 - 1));
    recovered = std::max(recovered, std::abs(P[i](0, 0) / 1000 - 1));
    mass += s.mass(i);
  }
  CHECK(stress < tolerance);
  CHECK(recovered < tolerance);
  CHECK(mass == doctest::Approx(0.1 * 8000 * std::pow(0.04, D - 1)).epsilon(1e-12));
  const double dt = 1e-10;
  s.run(dt, {.cfl = 1e3, .max_step = dt});
  for (std::size_t i = 0; i < s.size(); ++i) force = std::max(force, s.mass(i) * s.velocity(i).norm() / dt);
  CHECK(force < std::max(tolerance, of_forces) * 1000 * std::pow(0.02, D - 1));
}

Method with(const char* formulation, const char* operators, double support_dx = 1.5) {
  return {.formulation = formulation,
          .operators = operators,
          .support_dx = support_dx,
          .pair_precision = PairPrecision::double_precision};
}

/// Tip deflection of a cantilever of two layers, 1 : 100.
double bilayer(int thick, const Method& method) {
  Simulation<2> s(make_cloud(box<2>({0, 0}, {1, 0.1}), {.dx = 0.1 / thick}), linear<2>(soft), method);
  s.set_material([](const Vec<2>& X) { return X[1] > 0.05 + 1e-9; },
                 linear<2>({.E = 1e8, .nu = 0, .density = 1000, .plane = Plane::stress}));
  s.clamp(s.face("x_min"));
  s.load(s.face("x_max"), {0, -1});
  CHECK(s.relax({.tolerance = 1e-4}).status == Status::ok);
  return -s.displacement_at({1, 0.05})[1];
}

}  // namespace

TEST_CASE_TEMPLATE("bars in series are exact, on either side of the interface", Dimension, Dim<1>, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double dx : {0.02, 0.01}) {
    if (D == 3 && dx < 0.02) continue;
    // `corrected` leaves 1e-5 of a constant stress inside; bonds, next to faces of 2D and 3D bodies, some
    // per cent.
    check_series<D>(with("tl_displacement", "corrected"), {.dx = dx}, 1e-9, 4e-5);
    check_series<D>(with("tl_displacement", "compatible"), {.dx = dx}, 1e-9);
    check_series<D>(with("tl_bond_associated", "corrected"), {.dx = dx}, 1e-9, D == 1 ? 0 : 0.1);
    check_series<D>(with("tl_stress_points", "corrected"), {.dx = dx, .cells = true}, 1e-9);
  }
  // Spacings that differ along the axes.
  check_series<D>(with("tl_displacement", "compatible"), {.dx = 0.0125}, 1e-9);
}

TEST_CASE("bars in series on jittered lattices are as exact as the closure") {
  Method method = with("tl_displacement", "compatible");
  method.compatible_iterations = 400;
  check_series<2>(method, {.dx = 0.02, .jitter = 0.2}, 1e-8);
}

TEST_CASE("the end of bars in series comes to rest where it should") {
  Simulation<2> s = series<2>(with("tl_displacement", "compatible"), {.dx = 0.02});
  CHECK(s.relax({.tolerance = 1e-8}).status == Status::ok);
  CHECK(s.displacement_at({0.2, 0.02})[0] == doctest::Approx(1.01e-4).epsilon(1e-8));
  CHECK(s.displacement_at({0.1, 0.02})[0] == doctest::Approx(1e-6).epsilon(1e-6));
  // Bonds are as far off as in a bar of one material, and no further.
  Simulation<2> bonds = series<2>(with("tl_bond_associated", "corrected"), {.dx = 0.02});
  CHECK(bonds.relax({.tolerance = 1e-8}).status == Status::ok);
  CHECK(bonds.displacement_at({0.2, 0.02})[0] == doctest::Approx(1.01e-4 * (1 - 0.0071)).epsilon(2e-4));
}

TEST_CASE_TEMPLATE("masses are those of the cells, for any materials", Dimension, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  Vec<D> max = Vec<D>::Constant(0.8);
  max[0] = 1;
  for (const char* formulation : {"tl_displacement", "tl_bond_associated", "tl_stress_points"})
    for (const double jitter : {0.0, 0.2}) {
      Simulation<D> s(make_cloud(box<D>(Vec<D>::Zero(), max), {.dx = 0.1, .jitter = jitter, .cells = true}),
                      linear<D>({.E = 1e6, .nu = 0.3, .density = 1000}), with(formulation, "corrected"));
      // Three that meet in a corner.
      s.set_material([](const Vec<D>& X) { return X[0] < 0.5 && X[D - 1] < 0.4; },
                     linear<D>({.E = 1e7, .nu = 0.2, .density = 2700}));
      s.set_material([](const Vec<D>& X) { return X[0] > 0.5 && X[D - 1] < 0.4; },
                     linear<D>({.E = 1e5, .nu = 0.4, .density = 13.7}));
      const double volume = std::pow(0.8, D - 1);
      const double expected = volume / 2 * (1000 + 0.5 * 2700 + 0.5 * 13.7);
      const auto sum = [&] {
        double mass = 0;
        for (std::size_t i = 0; i < s.size(); ++i) mass += s.mass(i);
        return mass;
      };
      CHECK(sum() == doctest::Approx(expected).epsilon(1e-12));
      s.prepare();
      CHECK(sum() == doctest::Approx(expected).epsilon(1e-12));
    }
}

TEST_CASE("bending across an interface converges with second order") {
  Method method = with("tl_displacement", "compatible");
  method.kernel = "quadratic";
  const double beam = 2.835e-4;
  const double four = bilayer(4, method), eight = bilayer(8, method);
  CHECK(four == doctest::Approx(2.42e-4).epsilon(0.02));
  CHECK(eight == doctest::Approx(2.73e-4).epsilon(0.01));
  CHECK((beam - four) / (beam - eight) > 3.2);
}

TEST_CASE_TEMPLATE("bodies of several materials keep momenta and energy", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const char* formulation : {"tl_displacement", "tl_bond_associated"})
    for (const char* operators : {"corrected", "compatible"}) {
      Method method = with(formulation, operators);
      if (method.formulation == "tl_displacement") method.zero_energy_control = 0.1;
      Simulation<D> s(brick<D>(D == 1 ? 40 : 6, 0.15),
                      make_material<D>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}), method);
      s.set_material([](const Vec<D>& X) { return X[0] > 1; },
                     make_material<D>("neo_hookean", {.E = 2e7, .nu = 0.2, .density = 3000}));
      s.set_velocity([](const Vec<D>& X) { return Vec<D>(wavy<D>(X, 1) + Vec<D>::Ones()); });
      s.prepare();
      const Vec<D> momentum = s.linear_momentum();
      const Vec<3> angular = angular_momentum(s);
      const double energy = s.kinetic_energy() + s.strain_energy();
      const auto result = s.run(
          1e9, {.cfl = 0.2, .progress = [](std::int64_t steps, double, double) { return steps < 300; }});
      CHECK(result.status == Status::ok);
      CHECK((s.linear_momentum() - momentum).norm() < 1e-12 * momentum.norm());
      CHECK((angular_momentum(s) - angular).norm() < 1e-11 * momentum.norm());
      CHECK(s.kinetic_energy() + s.strain_energy() == doctest::Approx(energy).epsilon(2e-3));
    }
}

TEST_CASE("a body of two materials that turns is free of stress") {
  const Mat<2> R = rotation<2>(0.7);
  for (const char* formulation : {"tl_displacement", "tl_bond_associated"}) {
    Simulation<2> s(brick<2>(8, 0.2), make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                    with(formulation, "compatible"));
    s.set_material([](const Vec<2>& X) { return X[1] > 0.5 && X[0] < 0.75; },
                   make_material<2>("neo_hookean", {.E = 1e8, .nu = 0.3, .density = 1000}));
    s.set_displacement([&](const Vec<2>& X) { return Vec<2>(R * X - X); });
    s.prepare();
    for (std::size_t i = 0; i < s.size(); ++i) CHECK(s.cauchy_stress(i).norm() < 1e-4);
  }
}

TEST_CASE_TEMPLATE("a part of a body of two materials moves as the same part of the whole", Dimension, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  const auto make = [](const Vec<D>& from, const char* formulation, double share) {
    const Vec<D> to = Vec<D>::Constant(0.5);
    Simulation<D> s(make_cloud(box<D>(from, to), {.dx = 0.1}),
                    make_material<D>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                    with(formulation, "corrected"));
    // A core, so that twins lie on the planes as well as off them.
    s.set_material([](const Vec<D>& X) { return X.cwiseAbs().maxCoeff() < 0.3; },
                   make_material<D>("neo_hookean", {.E = 1e7, .nu = 0.2, .density = 4000}));
    s.load(s.face("x_max"), 1e4 * share * Vec<D>::Unit(0));
    s.set_velocity([](const Vec<D>& X) { return Vec<D>(X); });
    return s;
  };
  for (const char* formulation : {"tl_displacement", "tl_bond_associated"}) {
    CAPTURE(formulation);
    Vec<D> low = Vec<D>::Constant(-0.5);
    low[0] = 0;
    const Vec<D> zero = Vec<D>::Zero();
    auto part = make(zero, formulation, std::pow(0.5, D - 1)), whole = make(low, formulation, 1);
    for (auto* s : {&part, &whole}) s->symmetry_plane(0, 0);
    for (int d = 1; d < D; ++d) part.symmetry_plane(d, 0);
    const RunOptions options{.cfl = 1e3, .max_step = 2e-4};
    CHECK(part.run(1e-2, options).status == Status::ok);
    CHECK(whole.run(1e-2, options).status == Status::ok);
    double largest = 0, difference = 0;
    std::size_t found = 0;
    for (std::size_t i = 0; i < part.size(); ++i)
      for (std::size_t j = 0; j < whole.size(); ++j) {
        if ((part.reference_position(i) - whole.reference_position(j)).norm() > 1e-6) continue;
        ++found;
        largest = std::max(largest, whole.displacement(j).norm());
        difference = std::max(difference, (part.displacement(i) - whole.displacement(j)).norm());
      }
    CHECK(found == part.size());
    CHECK(difference < 1e-9 * largest);
    CHECK(std::pow(2, D - 1) * part.strain_energy() == doctest::Approx(whole.strain_energy()).epsilon(1e-9));
  }
}

TEST_CASE("twins: one thread and two give the same bits") {
  const auto positions = [](int threads) {
    const int before = omp_get_max_threads();
    omp_set_num_threads(threads);
    Simulation<2> s(brick<2>(65, 0.15),
                    make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                    {.zero_energy_control = 0.1});
    s.set_material([](const Vec<2>& X) { return X[0] > 0.7; },
                   make_material<2>("neo_hookean", {.E = 1e7, .nu = 0.3, .density = 1000}));
    s.clamp(s.face("x_min"));
    s.load(s.face("x_max"), {1e3, 1e3});
    s.run(1e9, {.progress = [](std::int64_t step, double, double) { return step < 30; }});
    std::vector<Vec<2>> x;
    for (std::size_t i = 0; i < s.size(); ++i) x.push_back(s.position(i));
    omp_set_num_threads(before);
    return x;
  };
  const auto one = positions(1), two = positions(2);
  REQUIRE(one.size() == two.size());
  CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(one[0])) == 0);
}

TEST_CASE("a region of particles without a cell leaves materials to the particles") {
  Simulation<2> s(make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1}),
                  linear<2>({.E = 1e6, .nu = 0, .density = 1000}), {});
  s.set_material(s.face("x_max"), linear<2>({.E = 1e6, .nu = 0, .density = 5000}));
  s.prepare();
  double mass = 0;
  for (std::size_t i = 0; i < s.size(); ++i) mass += s.mass(i);
  CHECK(mass == doctest::Approx(0.5 * 1000 + 0.5 * 0.05 * 4000));
}
