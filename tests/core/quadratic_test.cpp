// The quadratic operator: exactness, adjointness, and what it says where it cannot be made.
#include <doctest/doctest.h>

#include <cmath>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D>
int spacings() {
  return D == 1 ? 20 : D == 2 ? 8 : 4;
}

Method quadratic(double support_dx = 2.4, PairPrecision precision = PairPrecision::double_precision) {
  return {.operators = "quadratic", .support_dx = support_dx, .pair_precision = precision};
}

// Largest error of the gradient of a quadratic without symmetry over all particles, boundaries included.
template <int D>
double error_of_quadratic(const Discretised<D>& body) {
  Vec<D> linear;
  Mat<D> H;
  for (int i = 0; i < D; ++i) {
    linear[i] = 0.7 - 0.4 * i;
    for (int j = 0; j < D; ++j) H(i, j) = 1.1 + 0.3 * (i + j) - 0.8 * i * j;
  }
  double largest = 0;
  for (Index a = 0; a < body.particles.n; ++a) {
    const Vec<D> gradient =
        body.gradient(a, [&](const Vec<D>& X) { return 2 + linear.dot(X) + 0.5 * X.dot(H * X); });
    largest = std::max(largest, (gradient - linear - H * body.X(a)).norm());
  }
  return largest;
}

}  // namespace

TEST_CASE_TEMPLATE("quadratic operators: gradients of quadratics are exact, on the boundary too", Dimension,
                   Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15})
    for (const double support : {2.4, 3.2})
      for (const auto lattice : {Lattice::node_centred, Lattice::cell_centred}) {
        CAPTURE(jitter);
        CAPTURE(support);
        CAPTURE(static_cast<int>(lattice));
        const auto cloud = brick<D>(spacings<D>(), jitter, lattice);
        CHECK(error_of_quadratic(Discretised<D>(cloud, quadratic(support))) < 1e-12);
        // In single precision what is left is the rounding of the vectors.
        const Discretised<D> rounded(cloud, quadratic(support, PairPrecision::single_precision));
        CHECK(error_of_quadratic(rounded) < 1e-5);
        CHECK(error_of_quadratic(rounded) > 1e-12);
        // The comparison sees a difference: linear exactness alone is far off.
        Method corrected = quadratic(support);
        corrected.operators = "corrected";
        CHECK(error_of_quadratic(Discretised<D>(cloud, corrected)) > 1e-3);
      }
}

TEST_CASE_TEMPLATE("quadratic operators: linear fields are exact in single precision as well", Dimension,
                   Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const Discretised<D> body(brick<D>(spacings<D>(), 0.15), quadratic(2.4, PairPrecision::single_precision));
  const Vec<D> slope = Vec<D>::LinSpaced(0.5, 1.7);
  double largest = 0;
  for (Index a = 0; a < body.particles.n; ++a)
    largest = std::max(largest,
                       (body.gradient(a, [&](const Vec<D>& X) { return 3 + slope.dot(X); }) - slope).norm());
  CHECK(largest < 1e-12);
}

TEST_CASE_TEMPLATE("quadratic operators: what is stored beside G_ab is -G_ba to the last bit", Dimension,
                   Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const Discretised<D> body(brick<D>(spacings<D>(), 0.15), quadratic());
  bool conjugate = true, antisymmetric = true;
  for (Index a = 0; a < body.particles.n; ++a)
    body.pairs.for_each(a, [&](Index b, std::int64_t k, int lane) {
      body.pairs.for_each(b, [&](Index back, std::int64_t kb, int lb) {
        if (back != a) return;
        const Vec<D> minus_g_ba = vector_in<D>(body.op.adjoint_d, k, lane);
        conjugate = conjugate && minus_g_ba == -vector_in<D>(body.op.vectors_d, kb, lb);
        antisymmetric = antisymmetric && minus_g_ba == vector_in<D>(body.op.vectors_d, k, lane);
      });
    });
  CHECK(conjugate);
  CHECK_FALSE(antisymmetric);
}

TEST_CASE_TEMPLATE("quadratic operators: forces are the slope of the energy and sum to zero", Dimension,
                   Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const auto precision : {PairPrecision::single_precision, PairPrecision::double_precision}) {
    CAPTURE(static_cast<int>(precision));
    Bare<D> body(brick<D>(spacings<D>(), 0.15),
                 make_material<D>("neo_hookean", {.E = 10, .nu = 0.3, .density = 1000}),
                 quadratic(2.4, precision));
    const auto place = [&](double along) {
      body.place([&](const Vec<D>& X) {
        return Vec<D>(X + wavy<D>(X, 0.03) + along * wavy<D>(Vec<D>(3.1 * X), 1));
      });
    };
    constexpr double eps = 1e-5;
    place(eps);
    const double above = body.formulation->strain_energy();
    place(-eps);
    const double below = body.formulation->strain_energy();
    place(0);
    const auto force = body.forces();
    double power = 0, amount = 0;
    Vec<D> sum = Vec<D>::Zero();
    for (Index i = 0; i < body.n(); ++i) {
      const auto& f = force[static_cast<std::size_t>(i)];
      power += f.dot(wavy<D>(Vec<D>(3.1 * body.X(i)), 1));
      sum += f;
      amount += f.norm();
    }
    CHECK(-(above - below) / (2 * eps) == doctest::Approx(power).epsilon(1e-6));
    CHECK(amount > 0.01);
    CHECK(sum.norm() < 1e-12 * amount);
  }
}

TEST_CASE("quadratic operators keep momentum and energy of a free vibration") {
  Simulation<2> body(brick<2>(8, 0.15),
                     make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                     quadratic(2.4, PairPrecision::single_precision));
  body.set_velocity(
      [](const Vec<2>& X) { return Vec<2>(wavy<2>(Vec<2>(2 * X), 0.5) + Vec<2>::Constant(1)); });
  check_free_vibration(body);
}

TEST_CASE_TEMPLATE("quadratic operators: particles whose neighbours are too few are named", Dimension, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(4);
  try {
    const Discretised<D> body(cloud, quadratic(1.5));
    FAIL("support_dx = 1.5 was accepted");
  } catch (const InputError& error) {
    const std::string what = error.what();
    CAPTURE(what);
    CHECK(what.find("quadratic operator: the ") != std::string::npos);
    CHECK(what.find(D == 2 ? "which takes 5" : "which takes 9") != std::string::npos);
    CHECK(what.find("Enlarge support_dx") != std::string::npos);
  }
  Cloud<D> lonely = brick<D>(4);
  lonely.X.push_back(Vec<D>::Constant(9));
  lonely.V.push_back(lonely.V.front());
  lonely.B.push_back(Vec<D>::Zero());
  const std::string expected = "the 0 neighbour(s) of particle " + std::to_string(cloud.size()) + " at (9, 9";
  CHECK_THROWS_WITH_AS(Discretised<D>(lonely, quadratic()), doctest::Contains(expected.c_str()), InputError);
}

TEST_CASE("quadratic operators: neighbours that hardly determine a quadratic count as too few") {
  Cloud<1> cloud;
  cloud.dx = 1;
  for (const double x : {0.0, 1.0, 1.001, 2.0, 3.0, 4.0}) cloud.X.emplace_back(x);
  cloud.V.assign(cloud.X.size(), 1.0);
  // From 0 only 1 and 1.001 are within reach: weights of a thousand either way.
  CHECK_THROWS_WITH_AS(Discretised<1>(cloud, quadratic(1.6)),
                       doctest::Contains("the 2 neighbour(s) of particle 0 at (0) do not determine"),
                       InputError);
  cloud.X[2][0] = 1.5;
  CHECK(error_of_quadratic(Discretised<1>(cloud, quadratic(2.1))) < 1e-12);
}

TEST_CASE("quadratic operators refuse vectors that are shared or recomputed, and stand in the list") {
  for (const auto precision : {PairPrecision::shared, PairPrecision::recomputed})
    CHECK_THROWS_WITH_AS(Discretised<2>(brick<2>(4), quadratic(2.4, precision)),
                         doctest::Contains("the pair vectors of quadratic operators cannot be"), InputError);
  Method method = quadratic();
  method.operators = "cubic";
  CHECK_THROWS_WITH_AS(Discretised<2>(brick<2>(4), method), doctest::Contains("antisymmetric, quadratic"),
                       InputError);
}
