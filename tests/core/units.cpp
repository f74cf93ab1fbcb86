// The same body in other units of length, mass and time has the same answer: bit for bit where the units
// differ by powers of two, to 1e-6 where they are those of practice.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <taut/base/powers.hpp>
#include <taut/taut.hpp>
#include <vector>

using namespace taut;

namespace {

/// A unit is so many metres, kilograms, seconds.
struct Units {
  double m = 1, kg = 1, s = 1;
  double length(double x) const { return x / m; }
  double time(double t) const { return t / s; }
  double pressure(double p) const { return p / kg * m * s * s; }
  double density(double rho) const { return rho / kg * m * m * m; }
  double velocity(double v) const { return v / m * s; }
  double acceleration(double a) const { return a / m * s * s; }
  /// Per unit thickness in 2D, per unit area in 1D.
  double force(double f, int D) const { return f / kg * s * s / int_power(m, D - 2); }
};

std::vector<Units> binary_units() {
  const auto two = [](int n) { return std::ldexp(1.0, n); };
  return {{two(10), two(-7), two(5)},
          {two(-11), two(3), two(-8)},
          {two(-20), two(-30), two(-13)},
          {two(3), 1, 1},
          {1, two(1), 1},
          {1, 1, two(-1)}};
}
const std::vector<Units> practical_units{
    {1e3, 1, 1}, {1e-3, 1, 1}, {1e-3, 1e3, 1}, {1e-3, 1e-3, 1e-3}, {0.3048, 0.4536, 60}};

struct Answer {
  std::vector<double> values;
  std::int64_t steps = 0;
};

enum class From { lattice, jittered, cell_centred, csv, csv_of_points };

template <int D>
Cloud<D> body(const Units& in, From from) {
  Vec<D> max;
  max[0] = in.length(1);
  for (int d = 1; d < D; ++d) max[d] = in.length(0.4);
  LatticeOptions options{.dx = in.length(0.11)};  // does not divide the box
  options.lattice = from == From::cell_centred ? Lattice::cell_centred : Lattice::node_centred;
  options.jitter = from == From::jittered || from == From::csv ? 0.2 : 0;
  options.cells = from == From::lattice || from == From::jittered;
  const Cloud<D> cloud = make_cloud(box<D>(Vec<D>::Zero(), max), options);
  if (from != From::csv && from != From::csv_of_points) return cloud;
  const auto file = std::filesystem::temp_directory_path() / "taut_units.csv";
  std::ofstream out(file);
  out << (from == From::csv ? "x,y,volume,bx,by\n" : "x,y\n");
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    out << fmt::format("{},{}", cloud.X[i][0], cloud.X[i][1]);
    if (from == From::csv) out << fmt::format(",{},{},{}", cloud.V[i], cloud.B[i][0], cloud.B[i][1]);
    out << '\n';
  }
  out.close();
  Cloud<D> read = read_cloud<D>(file);
  std::filesystem::remove(file);
  return read;
}

enum class Solve { run, relax };

/// Values in SI of a bar that is held at one end, pulled and bent by a load, its weight and a moving part.
template <int D>
Answer answer(const Units& in, Method method, From from, Solve solve) {
  const bool updated = method.formulation.starts_with("ul_");
  if (updated) method.support_dx = 2.4;
  if (method.operators == "quadratic") method.support_dx = 2.6;
  Simulation<D> s(body<D>(in, from),
                  make_material<D>(updated ? "hypoelastic" : "neo_hookean",
                                   {.E = in.pressure(1e6), .nu = 0.3, .density = in.density(1000)}),
                  method);
  s.clamp(s.face("x_min"));
  Vec<D> force = Vec<D>::Zero(), weight = Vec<D>::Zero();
  force[0] = in.force(1000, D);
  force[D - 1] = in.force(1000, D) / 2;
  weight[D - 1] = in.acceleration(-1.5);
  s.load(s.face("x_max"), force, [period = in.time(0.05)](double t) { return std::min(1.0, t / period); });
  s.body_force(weight);
  if (D > 1 && solve == Solve::run)
    s.prescribe([far = in.length(0.35),
                 near = in.length(0.3)](const Vec<D>& X) { return X[D - 1] > far && X[0] < near; },
                0,
                [size = in.length(1e-3), period = in.time(0.1)](const Vec<D>&, double t) {
                  const double q = t / period;
                  return size * q * q;
                });
  Answer a;
  if (solve == Solve::run) {
    const auto result = s.run(in.time(0.1));
    CHECK(result.status == Status::ok);
    a.steps = result.steps;
  } else {
    const auto result = s.relax({.tolerance = 1e-4, .ramp_time = in.time(0.1), .max_steps = 3000});
    CHECK(result.status == Status::ok);
    a.steps = result.steps;
  }
  const double of_pressure = 1 / in.pressure(1), of_length = in.m;
  for (std::size_t i = 0; i < s.size(); ++i)
    for (int d = 0; d < D; ++d) a.values.push_back(s.displacement(i)[d] * of_length);
  for (std::size_t i = 0; i < s.size(); i += 7)
    for (int d = 0; d < D; ++d) a.values.push_back(s.cauchy_stress(i)(0, d) * of_pressure);
  Vec<D> probe = Vec<D>::Constant(in.length(0.233));
  for (int d = 0; d < D; ++d) a.values.push_back(s.displacement_at(probe)[d] * of_length);
  if (!updated) a.values.push_back(s.strain_energy() / in.force(1, D) * of_length);
  return a;
}

template <int D>
void check_units(const Method& method, From from, Solve solve) {
  CAPTURE(D);
  CAPTURE(method.formulation);
  CAPTURE(method.operators);
  CAPTURE(static_cast<int>(from));
  CAPTURE(static_cast<int>(solve));
  const Answer si = answer<D>({}, method, from, solve);
  for (const Units& units : binary_units()) {
    CAPTURE(units.m);
    CAPTURE(units.kg);
    CAPTURE(units.s);
    const Answer other = answer<D>(units, method, from, solve);
    CHECK(other.steps == si.steps);
    REQUIRE(other.values.size() == si.values.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < si.values.size(); ++i) different += other.values[i] != si.values[i];
    CHECK(different == 0);
  }
}

}  // namespace

TEST_CASE("units: powers of two change no bit of pair forms") {
  for (const char* operators : {"standard", "corrected", "compatible", "antisymmetric", "quadratic"})
    for (const From from : {From::lattice, From::jittered})
      for (const Solve solve : {Solve::run, Solve::relax}) {
        if (solve == Solve::relax && operators != std::string("corrected") &&
            operators != std::string("compatible"))
          continue;
        check_units<2>({.operators = operators}, from, solve);
      }
  check_units<2>({.formulation = "tl_bond_associated"}, From::jittered, Solve::run);
  check_units<2>({.operators = "compatible", .kernel = "quadratic"}, From::cell_centred, Solve::relax);
  check_units<1>({}, From::lattice, Solve::run);
  check_units<3>({.operators = "compatible"}, From::jittered, Solve::run);
  check_units<3>({}, From::lattice, Solve::run);
}

TEST_CASE("units: powers of two change no bit of stress points") {
  for (const From from : {From::lattice, From::jittered})
    for (const Solve solve : {Solve::run, Solve::relax})
      check_units<2>({.formulation = "tl_stress_points"}, from, solve);
  check_units<1>({.formulation = "tl_stress_points"}, From::lattice, Solve::relax);
  check_units<3>({.formulation = "tl_stress_points"}, From::jittered, Solve::run);
}

TEST_CASE("units: powers of two change no bit of updated forms") {
  for (const char* form : {"ul_basic", "ul_artificial_stress"})
    for (const char* gradient : {"standard", "corrected"})
      check_units<2>({.formulation = form, .viscosity = 0.1, .velocity_gradient = gradient}, From::lattice,
                     Solve::run);
}

TEST_CASE("units: powers of two change no bit of clouds from files") {
  check_units<2>({.operators = "corrected"}, From::csv, Solve::relax);
  check_units<2>({.operators = "compatible"}, From::csv, Solve::run);
  check_units<2>({.operators = "compatible"}, From::csv_of_points, Solve::run);
}

TEST_CASE("units: those of practice change results by less than 1e-6") {
  for (const char* form : {"tl_displacement", "tl_stress_points"}) {
    const Method method{.formulation = form, .operators = "compatible"};
    const Answer si = answer<2>({}, method, From::jittered, Solve::run);
    double size = 0;
    for (std::size_t i = 0; i < 20; ++i) size = std::max(size, std::abs(si.values[i]));
    for (const Units& units : practical_units) {
      CAPTURE(units.m);
      const Answer other = answer<2>(units, method, From::jittered, Solve::run);
      REQUIRE(other.values.size() == si.values.size());
      for (std::size_t i = 0; i < si.values.size(); ++i)
        CHECK(other.values[i] ==
              doctest::Approx(si.values[i]).epsilon(1e-6).scale(std::abs(si.values[i]) < 1 ? size : 1e3));
    }
  }
}
