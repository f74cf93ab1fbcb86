// The bond-associated form: forces from an energy, exact on linear motions, and no zero-energy modes.
#include <doctest/doctest.h>

#include <taut/base/error.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

constexpr double E = 1e6;

template <int D>
std::shared_ptr<const Material<D>> rubber(double stiffness = E) {
  return make_material<D>("neo_hookean", {.E = stiffness, .nu = 0.3, .density = 1000});
}

// Operators that are linearly exact, with the smallest support that all clouds here allow.
constexpr std::pair<const char*, double> linear_operators[] = {
    {"corrected", 1.5}, {"corrected", 2.4}, {"compatible", 1.5}, {"antisymmetric", 1.5}, {"quadratic", 2.6}};

Method method(const char* operators, double support) {
  return {.formulation = "tl_bond_associated", .operators = operators, .support_dx = support};
}

template <int D>
Cloud<D> cloud_of(double jitter = 0.15) {
  return brick<D>(D == 1 ? 30 : D == 2 ? 8 : 6, jitter);
}

// A smooth motion and one of a few spacings.
template <int D>
Vec<D> rough(const Vec<D>& X, double dx) {
  return X + wavy<D>(X, 0.05) + wavy<D>(Vec<D>(2.5 / dx * X), 0.02 * dx);
}

}  // namespace

TEST_CASE_TEMPLATE("bond-associated: forces are minus the derivative of the energy", Dimension, Dim<1>,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = cloud_of<D>();
  const auto check = [&](const char* operators, double support) {
    CAPTURE(operators);
    Bare<D> body(cloud, rubber<D>(), method(operators, support));
    body.place([&](const Vec<D>& X) { return rough<D>(X, cloud.dx); });
    check_derivative(body, cloud.dx, D == 3 ? 37 : 3);
  };
  check("standard", 1.5);
  for (const auto& [operators, support] : linear_operators) check(operators, support);
}

TEST_CASE_TEMPLATE("bond-associated: two materials", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = cloud_of<D>();
  const Method how = method("corrected", 1.5);
  std::vector<std::uint8_t> material(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) material[i] = cloud.X[i][0] > 0.7;
  Bare<D> body(cloud, {rubber<D>(), rubber<D>(20 * E)}, material, how);
  body.place([&](const Vec<D>& X) { return rough<D>(X, cloud.dx); });
  check_derivative(body, cloud.dx, D == 3 ? 37 : 3);
}

TEST_CASE_TEMPLATE("bond-associated: a linear motion has the energy of its gradient, each volume once",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = cloud_of<D>();
  Mat<3> A3;
  A3 << 1.3, 0.4, -0.2, -0.1, 0.8, 0.3, 0.25, -0.15, 1.1;
  const Mat<D> A = A3.topLeftCorner<D, D>();
  double volume = 0;
  for (const double V : cloud.V) volume += V;
  std::vector<double> F(D * D * lanes), P(D * D * lanes), energy(lanes);
  for (int c = 0; c < D * D; ++c) std::fill_n(F.begin() + c * lanes, lanes, A(c / D, c % D));
  dynamic_cast<const Hyperelastic<D>&>(*rubber<D>())
      .stress({lanes, lanes, F.data(), P.data(), energy.data()});
  for (const auto& [operators, support] : linear_operators) {
    CAPTURE(operators);
    Bare<D> body(cloud, rubber<D>(), method(operators, support));
    body.place([&](const Vec<D>& X) { return Vec<D>(A * X); });
    CHECK(body.formulation->strain_energy() == doctest::Approx(volume * energy[0]).epsilon(1e-10));
    double error = 0;
    for (Index i = 0; i < body.n(); ++i)
      error =
          std::max(error, (body.formulation->deformation_gradient(i) - A).template lpNorm<Eigen::Infinity>());
    CHECK(error < 1e-12);
  }
}

TEST_CASE_TEMPLATE("bond-associated: a constant stress makes no force inside a lattice, a rotation none",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15}) {
    const auto cloud = cloud_of<D>(jitter);
    Bare<D> body(cloud, rubber<D>(), method("corrected", 1.5));
    const double scale = E * std::pow(cloud.dx, D - 1);
    body.place([&](const Vec<D>& X) { return Vec<D>(rotation<D>(2.5) * X + Vec<D>::Constant(0.5)); });
    double largest = 0;
    for (const auto& f : body.forces()) largest = std::max(largest, f.norm());
    CHECK(largest < 1e-12 * scale);
    if (jitter > 0) continue;
    body.place([&](const Vec<D>& X) { return Vec<D>(1.1 * X); });
    const auto forces = body.forces();
    for (Index i = 0; i < body.n(); ++i) {
      Vec<D> max = Vec<D>::Ones();
      max[0] = 1.5;
      if (std::min(body.X(i).minCoeff(), (max - body.X(i)).minCoeff()) < 2.5 * cloud.dx) continue;
      CHECK(forces[static_cast<std::size_t>(i)].norm() <
            1e-6 * scale);  // pair vectors are in single precision
    }
  }
}

TEST_CASE_TEMPLATE("bond-associated: internal forces and moments cancel", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = cloud_of<D>();
  for (const auto& [operators, support] : linear_operators) {
    CAPTURE(operators);
    Bare<D> body(cloud, rubber<D>(), method(operators, support));
    body.place([&](const Vec<D>& X) { return rough<D>(X, cloud.dx); });
    check_balance(body);
  }
}

TEST_CASE_TEMPLATE("bond-associated: motions that the gradients do not see have energy", Dimension, Dim<1>,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = cloud_of<D>(0);
  const double amplitude = 1e-3 * cloud.dx;
  // Signs that change from particle to particle along the axes whose bits are set: along one, stripes; along
  // all, a checkerboard.
  for (int axes = 1; axes < 1 << D; ++axes) {
    CAPTURE(axes);
    Bare<D> body(cloud, rubber<D>(), method("corrected", 1.5));
    body.place([&](const Vec<D>& X) {
      long parity = 0;
      for (int d = 0; d < D; ++d)
        if (axes >> d & 1) parity += std::lround(X[d] / cloud.dx);
      return Vec<D>(X + Vec<D>::Constant(parity % 2 ? -amplitude : amplitude));
    });
    // Neighbours along one of the axes differ by 2 A: a strain of 2 A / dx, in at least the share of the
    // bonds along one axis of D.
    const double strain = 2 * amplitude / cloud.dx;
    CHECK(body.formulation->strain_energy() > 0.5 * E * strain * strain / D * 1.5 * 0.5);
  }
}

TEST_CASE_TEMPLATE("bond-associated: a free body keeps momenta and energy over 10000 steps", Dimension,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  Simulation<D> s(brick<D>(D == 2 ? 8 : 4, 0.15), rubber<D>(), method("corrected", 1.5));
  s.set_displacement([](const Vec<D>& X) { return wavy<D>(X, 0.02); });
  s.set_velocity([](const Vec<D>&) { return Vec<D>::Constant(0.5); });
  s.prepare();
  const Vec<D> momentum = s.linear_momentum();
  // The energy of single instants moves by (omega dt)^2 / 4 of the part of the shortest waves, to and fro.
  double first = 0, last = 0;
  const auto result = s.run(1e9, {.cfl = 0.1, .progress = [&](std::int64_t step, double, double) {
                                    const double now = s.kinetic_energy() + s.strain_energy();
                                    if (step <= 1000) first += now / 1000;
                                    if (step > 9000) last += now / 1000;
                                    return step < 10000;
                                  }});
  CHECK(result.status == Status::ok);
  CHECK((s.linear_momentum() - momentum).norm() < 1e-12 * momentum.norm());
  CHECK(last == doctest::Approx(first).epsilon(1e-3));
}

TEST_CASE_TEMPLATE("bond-associated: the frequency bound holds", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const auto& [operators, support] : linear_operators)
    for (const double nu : {0.0, 0.3, 0.45}) {
      CAPTURE(operators);
      CAPTURE(nu);
      check_stable_step(cloud_of<D>(), make_material<D>("neo_hookean", {.E = E, .nu = nu, .density = 1000}),
                        method(operators, support));
    }
}

TEST_CASE("bond-associated: a jittered cantilever comes to rest") {
  for (const auto& [operators, support] : linear_operators) {
    CAPTURE(operators);
    Simulation<2> beam(make_cloud(box<2>({0, 0}, {0.2, 0.02}), {.dx = 4e-3, .jitter = 0.15}),
                       make_material<2>("st_venant_kirchhoff",
                                        {.E = 20e6, .nu = 0, .density = 1000, .plane = Plane::stress}),
                       method(operators, support));
    beam.clamp(beam.face("x_min"));
    beam.load(beam.face("x_max"), {0, -250});
    CHECK(beam.relax({.max_steps = 100000}).status == Status::ok);
  }
}

TEST_CASE("bond-associated: control on top is refused") {
  Method how = method("corrected", 1.5);
  how.zero_energy_control = 1;
  // When the method is given, before anything is set up.
  CHECK_THROWS_WITH_AS(Simulation<2>(brick<2>(8), rubber<2>(), how), doctest::Contains("zero_energy_control"),
                       InputError);
}
