// Stress points: what cells see, what they do not, and what their forces keep.
#include <doctest/doctest.h>
#include <omp.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cstring>
#include <numbers>
#include <taut/base/error.hpp>
#include <taut/particles/material_groups.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

constexpr double E = 1e6;

template <int D>
std::shared_ptr<const Material<D>> rubber(const char* name = "neo_hookean") {
  return make_material<D>(name, {.E = E, .nu = 0.3, .density = 1000});
}

Method stress_points(std::optional<double> control = {}) {
  return {.formulation = "tl_stress_points", .zero_energy_control = control};
}

// As `brick`, with its cells.
template <int D>
Cloud<D> celled_brick(int n, double jitter = 0) {
  Vec<D> max = Vec<D>::Ones();
  max[0] = 1.5;
  return make_cloud(box<D>(Vec<D>::Zero(), max), {.dx = 1.0 / n, .jitter = jitter, .seed = 7, .cells = true});
}

template <int D>
int spacings() {
  return D == 1 ? 40 : D == 2 ? 14 : 6;
}

template <int D>
Mat<D> some_gradient() {
  Mat<3> A;
  A << 1.3, 0.4, -0.2, -0.1, 0.8, 0.3, 0.25, -0.15, 1.1;
  return A.topLeftCorner<D, D>();
}

template <int D>
double largest(const std::vector<Vec<D>>& forces) {
  double value = 0;
  for (const auto& f : forces) value = std::max(value, f.norm());
  return value;
}

// A rounded body with holes: rows of cells that begin, end and break off anywhere.
template <int D>
Shape<D> cheese() {
  if constexpr (D == 1) {
    return box<1>(Vec<1>(-1), Vec<1>(1));
  } else {
    return sphere<D>(Vec<D>::Zero(), 1.0) - sphere<D>(Vec<D>::Constant(0.3), 0.3) -
           sphere<D>(Vec<D>::Constant(-0.35), 0.25);
  }
}

}  // namespace

TEST_CASE_TEMPLATE("lattice cells fill the body and share out the particles' volumes", Dimension, Dim<1>,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const int samples : {1, 3}) {
    CAPTURE(samples);
    const auto cloud = make_cloud(cheese<D>(), {.dx = 0.13, .samples = samples, .cells = true});
    CHECK(cloud.cell_share.empty() == (samples == 1 || D == 1));
    std::vector<double> V(cloud.size(), 0.0);
    for (std::size_t q = 0; q < cloud.cells.size(); ++q) {
      const auto& cell = cloud.cells[q];
      const auto X = [&](int c) {
        return cloud.X[static_cast<std::size_t>(cell[static_cast<std::size_t>(c)])];
      };
      double volume = cloud.cell_share.empty() ? 1 : cloud.cell_share[q];
      for (int d = 0; d < D; ++d) volume *= X(1 << d)[d] - X(0)[d];
      for (int c = 0; c < 1 << D; ++c) {
        for (int d = 0; d < D; ++d) CHECK(X(c)[d] == X(c >> d & 1 ? 1 << d : 0)[d]);
        V[static_cast<std::size_t>(cell[static_cast<std::size_t>(c)])] += volume / (1 << D);
      }
    }
    for (std::size_t i = 0; i < cloud.size(); ++i) CHECK(V[i] == doctest::Approx(cloud.V[i]).epsilon(1e-12));
  }
}

TEST_CASE_TEMPLATE("stress points: linear fields have their gradient and no hourglass energy", Dimension,
                   Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15, 0.4}) {
    CAPTURE(jitter);
    double energy[2];
    for (const int k : {0, 1}) {
      Bare<D> body(celled_brick<D>(spacings<D>(), jitter), rubber<D>(), stress_points(k * 100.0));
      const Mat<D> F = some_gradient<D>();
      body.place([&](const Vec<D>& X) { return Vec<D>(F * X + Vec<D>::LinSpaced(0.1, 0.3)); });
      double error = 0;
      for (Index i = 0; i < body.n(); ++i)
        error = std::max(error, (body.formulation->deformation_gradient(i) - F).cwiseAbs().maxCoeff());
      CHECK(error < 1e-12);
      energy[k] = body.formulation->strain_energy();
    }
    CHECK(energy[0] > 0.01 * E);
    CHECK(energy[1] == doctest::Approx(energy[0]).epsilon(1e-13));
  }
}

TEST_CASE_TEMPLATE("stress points: a constant stress makes the tractions of the faces and no force inside",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15, 0.4}) {
    CAPTURE(jitter);
    Bare<D> body(celled_brick<D>(spacings<D>(), jitter), rubber<D>(), stress_points());
    const Mat<D> F = some_gradient<D>();
    body.place([&](const Vec<D>& X) { return Vec<D>(F * X); });
    const auto forces = body.forces();
    const Mat<D> P = body.formulation->first_piola_kirchhoff(0);
    REQUIRE(P.norm() > 1e4);
    double error = 0;
    for (Index i = 0; i < body.n(); ++i) {
      const Vec<D> traction = -P * body.particles.B[static_cast<std::size_t>(i)];
      error = std::max(error, (forces[static_cast<std::size_t>(i)] - traction).norm());
    }
    CHECK(error < 1e-12 * P.norm() * std::pow(body.particles.dx, D - 1));
  }
}

TEST_CASE("stress points: partly filled cells close as well") {
  const auto cloud = make_cloud(cheese<2>(), {.dx = 0.07, .jitter = 0.2, .samples = 4, .cells = true});
  Bare<2> body(cloud, rubber<2>(), stress_points());
  const Mat<2> F = some_gradient<2>();
  body.place([&](const Vec<2>& X) { return Vec<2>(F * X); });
  const auto forces = body.forces();
  const Mat<2> P = body.formulation->first_piola_kirchhoff(0);
  double error = 0;
  for (Index i = 0; i < body.n(); ++i)
    error = std::max(
        error,
        (forces[static_cast<std::size_t>(i)] + P * body.particles.B[static_cast<std::size_t>(i)]).norm());
  CHECK(error < 1e-12 * P.norm() * cloud.dx);
}

TEST_CASE_TEMPLATE("stress points: a rigid motion makes no force", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15})
    for (const double degrees : {0.0, 30.0, 180.0}) {
      CAPTURE(jitter);
      CAPTURE(degrees);
      Bare<D> body(celled_brick<D>(spacings<D>(), jitter), rubber<D>(), stress_points());
      const Mat<D> R = rotation<D>(degrees * std::numbers::pi / 180);
      body.place([&](const Vec<D>& X) { return Vec<D>(R * X + Vec<D>::Constant(0.5)); });
      CHECK(largest<D>(body.forces()) < 1e-12 * E * std::pow(body.particles.dx, D - 1));
    }
}

TEST_CASE_TEMPLATE("stress points: forces are minus the derivative of the strain energy", Dimension, Dim<1>,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const char* name : {"linear_elastic", "st_venant_kirchhoff", "neo_hookean"})
    for (const double jitter : {0.0, 0.15})
      for (const double control : {0.0, 1.0}) {
        CAPTURE(name);
        CAPTURE(jitter);
        CAPTURE(control);
        Bare<D> body(celled_brick<D>(D == 1 ? 30 : 6, jitter), rubber<D>(name), stress_points(control));
        body.place([&](const Vec<D>& X) {
          return Vec<D>(X + wavy<D>(X, 0.05) + wavy<D>(Vec<D>(23 * X), 0.1 * body.particles.dx));
        });
        check_derivative(body, body.particles.dx, D == 3 ? 37 : 3);
      }
}

TEST_CASE_TEMPLATE("stress points: both momenta stay, and the energy to the integrator's order", Dimension,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15}) {
    CAPTURE(jitter);
    Simulation<D> s(celled_brick<D>(D == 2 ? 8 : 4, jitter), rubber<D>(), stress_points());
    // The slowest vibration of the bar, which a step of a twentieth of the stable one follows.
    s.set_displacement([](const Vec<D>& X) {
      Vec<D> u = Vec<D>::Zero();
      u[0] = 0.01 * std::cos(std::numbers::pi * X[0] / 1.5);
      return u;
    });
    s.set_velocity([](const Vec<D>&) { return Vec<D>(Vec<D>::Constant(0.1)); });
    s.run(0);
    double amount = 0;
    for (std::size_t i = 0; i < s.size(); ++i) amount += s.mass(i) * s.velocity(i).norm();
    const Vec<D> momentum = s.linear_momentum();
    const Vec<3> before = angular_momentum<D>(s);
    const double moving = 0.5 * momentum.squaredNorm() / (1000 * 1.5);
    const double energy = s.kinetic_energy() + s.strain_energy() - moving;
    double low = energy, high = energy;
    const auto result = s.run(1e9, {.cfl = 0.05, .progress = [&](std::int64_t step, double, double) {
                                      const double now = s.kinetic_energy() + s.strain_energy() - moving;
                                      low = std::min(low, now);
                                      high = std::max(high, now);
                                      return step < 10000;
                                    }});
    CHECK(result.status == Status::ok);
    CHECK((s.linear_momentum() - momentum).norm() < 1e-12 * amount);
    CHECK((angular_momentum<D>(s) - before).norm() < 1e-12 * amount);
    CHECK(high - low < 1e-3 * energy);
  }
}

TEST_CASE_TEMPLATE("stress points: the hourglass mode is free without control and held with it", Dimension,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = celled_brick<D>(D == 2 ? 12 : 8);
  const double amplitude = 1e-3 * cloud.dx;
  const auto sign = [&](const Vec<D>& X) {
    long parity = 0;
    for (int d = 0; d < 2; ++d) parity += std::lround(X[d] / cloud.dx);
    return parity % 2 ? -1.0 : 1.0;
  };
  const auto zigzag = [&](const Vec<D>& X) {
    Vec<D> x = X;
    x[0] += amplitude * sign(X);
    return x;
  };
  Bare<D> free(cloud, rubber<D>(), stress_points(0)), held(cloud, rubber<D>(), stress_points(0.5));
  free.place(zigzag);
  held.place(zigzag);
  const auto without = free.forces(), with = held.forces();
  // A cell bent by A xi eta has the energy 1/2 E' (2 A / dx)^2 dx^D / 3; a particle has 2^-D of each of its
  // 2^D.
  const double modulus = D == 2 ? E / (1 - 0.09) : E;
  const double expected = 0.5 * modulus * std::pow(cloud.dx, D - 2) * 4 / 3 * amplitude;
  int checked = 0;
  for (Index i = 0; i < free.n(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    CHECK(without[k].norm() < 1e-9 * expected);
    if (free.particles.B[k].norm() > 0) continue;
    ++checked;
    CHECK(-with[k][0] * sign(free.X(i)) == doctest::Approx(expected).epsilon(1e-10));
  }
  CHECK(checked > 5);
}

TEST_CASE_TEMPLATE("stress points: the highest frequency bounds that of any motion, closely", Dimension,
                   Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15})
    for (const double control : {0.0, 1.0, 20.0}) {
      CAPTURE(jitter);
      CAPTURE(control);
      const auto status = [&](double cfl) {
        Simulation<D> s(celled_brick<D>(D == 1   ? 20
                                        : D == 2 ? 8
                                                 : 4,
                                        jitter),
                        rubber<D>("linear_elastic"), stress_points(control));
        s.set_velocity([&](const Vec<D>& X) { return wavy<D>(Vec<D>(1e4 * X), 1e-3); });
        const auto result =
            s.run(1e9, {.cfl = cfl, .max_step = 1, .progress = [](std::int64_t step, double, double) {
                          return step < 3000;
                        }});
        return result.status;
      };
      CHECK(status(0.95) == Status::ok);
      CHECK(status(1.3) == Status::broke);
    }
}

TEST_CASE_TEMPLATE("stress points: one thread and two give the same bits", Dimension, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15})
    for (const bool holes : {false, true}) {
      const auto cloud =
          holes ? make_cloud(cheese<D>(), {.dx = D == 2 ? 0.024 : 0.1, .jitter = jitter, .cells = true})
                : celled_brick<D>(D == 2 ? 65 : 16, jitter);
      REQUIRE(static_cast<Index>(cloud.size()) > parallel_from);
      const auto positions = [&](int threads) {
        const int before = omp_get_max_threads();
        omp_set_num_threads(threads);
        Simulation<D> s(cloud, rubber<D>(), stress_points());
        s.clamp(s.face("x_min"));
        s.set_displacement([&](const Vec<D>& X) { return wavy<D>(X, 0.01); });
        const auto result =
            s.run(1e9, {.progress = [](std::int64_t step, double, double) { return step < 64; }});
        omp_set_num_threads(before);
        CHECK(result.status == Status::ok);
        std::vector<Vec<D>> x;
        for (std::size_t i = 0; i < s.size(); ++i) x.push_back(s.position(i));
        return x;
      };
      const auto one = positions(1), two = positions(2), three = positions(3);
      CHECK(std::memcmp(one.data(), two.data(), one.size() * sizeof(Vec<D>)) == 0);
      CHECK(std::memcmp(one.data(), three.data(), one.size() * sizeof(Vec<D>)) == 0);
    }
}

TEST_CASE_TEMPLATE("stress points: a part with symmetry planes moves as the same part of the whole",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  constexpr double dx = 0.1;
  const Vec<D> half = Vec<D>::Constant(0.5);
  const auto simulation = [&](const Vec<D>& min) {
    Simulation<D> s(make_cloud(box<D>(min, half), {.dx = dx, .cells = true}), rubber<D>(), stress_points());
    s.set_displacement([&](const Vec<D>& X) {
      Vec<D> u;
      for (int d = 0; d < D; ++d) {
        u[d] = 0.01 * std::sin((2 - 0.3 * d) * X[d]);
        for (int e = 0; e < D; ++e)
          if (e != d) u[d] *= std::cos((1 + 0.2 * e + 0.1 * d) * X[e]);
      }
      return u;
    });
    return s;
  };
  auto whole = simulation(-half), part = simulation(Vec<D>::Zero());
  for (int d = 0; d < D; ++d) part.symmetry_plane(d, 0);
  const RunOptions options{.cfl = 1e3, .max_step = 0.3 * dx / 40};
  CHECK(whole.run(40 * options.max_step, options).status == Status::ok);
  CHECK(part.run(40 * options.max_step, options).status == Status::ok);
  double size = 0, difference = 0, of_stress = 0;
  std::size_t found = 0;
  for (std::size_t i = 0; i < part.size(); ++i)
    for (std::size_t j = 0; j < whole.size(); ++j) {
      if ((part.reference_position(i) - whole.reference_position(j)).norm() > 1e-6 * dx) continue;
      ++found;
      size = std::max(size, whole.displacement(j).norm());
      difference = std::max(difference, (part.displacement(i) - whole.displacement(j)).norm());
      of_stress = std::max(of_stress, (part.cauchy_stress(i) - whole.cauchy_stress(j)).norm());
    }
  CHECK(found == part.size());
  CHECK(size > 1e-3);
  CHECK(difference < 1e-10 * size);
  CHECK(of_stress < 1e-9 * E);
  CHECK((1 << D) * part.strain_energy() == doctest::Approx(whole.strain_energy()).epsilon(1e-9));
}

TEST_CASE("stress points: a cell between two materials is of the first one") {
  const auto cloud = make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1, .cells = true});
  Simulation<2> s(cloud, rubber<2>("linear_elastic"), stress_points());
  s.set_material([](const Vec<2>& X) { return X[0] > 0.5 - 1e-9; },
                 make_material<2>("linear_elastic", {.E = 3 * E, .nu = 0.3, .density = 1000}));
  s.set_displacement([](const Vec<2>& X) { return Vec<2>(1e-3 * X[0], 0); });
  s.prepare();
  const double modulus = E * 0.7 / (1.3 * 0.4);
  for (std::size_t i = 0; i < s.size(); ++i) {
    const double x = cloud.X[i][0];
    const double times = std::abs(x - 0.5) < 1e-9 ? 2 : x < 0.5 ? 1 : 3;
    CHECK(s.first_piola_kirchhoff(i)(0, 0) == doctest::Approx(times * 1e-3 * modulus));
  }
}

TEST_CASE("stress points: a cell that turns inside out is named by its first corner") {
  const auto cloud = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 0.1, .cells = true});
  Simulation<2> s(cloud, rubber<2>(), stress_points());
  s.set_velocity([](const Vec<2>& X) { return Vec<2>(X[0] > 0.45 && X[0] < 0.55 ? 400 : 0, 0); });
  const auto result = s.run(1e-2);
  REQUIRE(result.status == Status::broke);
  CHECK(result.breakdown->what == "J <= 0");
  CHECK(result.breakdown->X[0] == doctest::Approx(0.5));
  CHECK(result.breakdown->x[0] > 0.55);
}

TEST_CASE("stress points: what they cannot take") {
  const auto message = [](const Cloud<2>& cloud, const char* material, double plane = -1) -> std::string {
    try {
      Simulation<2> s(cloud, make_material<2>(material, {.E = E, .nu = 0.3, .density = 1000}),
                      stress_points());
      if (plane >= 0) s.symmetry_plane(0, 0);
      s.prepare();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto says = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  const auto body = box<2>({0, 0}, {1, 1});
  LatticeOptions lattice{.dx = 0.1, .cells = false};
  CHECK(says(message(make_cloud(body, lattice), "neo_hookean"), "LatticeOptions::cells"));
  lattice.cells = true;
  const auto cloud = make_cloud(body, lattice);
  CHECK(message(cloud, "neo_hookean", 0) == "");
  CHECK(says(message(cloud, "hypoelastic"), "hyperelastic"));
  CHECK(says(message(make_cloud(box<2>({0.05, 0}, {1.05, 1}), lattice), "neo_hookean", 0),
             "no particle lies on"));
  lattice.lattice = Lattice::cell_centred;
  CHECK(says(message(make_cloud(body, lattice), "neo_hookean"), "Cell-centred lattices"));

  auto wrong = cloud;
  wrong.cells[3][2] = 1000;
  CHECK(says(message(wrong, "neo_hookean"), "corner 1000 of cell 3"));
  wrong = cloud;
  wrong.cells.erase(wrong.cells.begin());
  CHECK(says(message(wrong, "neo_hookean"), "particle 0 at (0, 0)"));
  wrong = cloud;
  for (auto& cell : wrong.cells) {
    std::swap(cell[0], cell[2]);
    std::swap(cell[1], cell[3]);
  }
  CHECK(says(message(wrong, "neo_hookean"), "turned inside out"));
  for (auto& cell : wrong.cells) std::swap(cell[1], cell[2]);
  CHECK(says(message(wrong, "neo_hookean"), "rows along x"));
  wrong = cloud;
  wrong.cell_share = {1.0};
  CHECK(says(message(wrong, "neo_hookean"), "shares"));
}
