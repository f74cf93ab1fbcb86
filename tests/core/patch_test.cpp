// Patch tests of the `corrected` operator: what it must give exactly, on lattices and jittered clouds, with
// pair vectors in either precision.
#include <doctest/doctest.h>

#include <numbers>

#include "discretised.hpp"

using namespace taut;

namespace {

constexpr PairPrecision precisions[] = {PairPrecision::single_precision, PairPrecision::double_precision};

template <int D>
Mat<D> some_gradient() {
  Mat<3> A;
  A << 1.3, 0.4, -0.2, -0.1, 0.8, 0.3, 0.25, -0.15, 1.1;
  return A.topLeftCorner(D, D);
}

template <int D>
int spacings() {
  return D == 1 ? 40 : D == 2 ? 14 : 7;
}

}  // namespace

TEST_CASE_TEMPLATE("patch test: a linear displacement has its gradient at every particle", Dimension, Dim<1>,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.15})
    for (const double support : {1.5, 2.4})
      for (const auto precision : precisions) {
        CAPTURE(jitter);
        CAPTURE(support);
        CAPTURE(static_cast<int>(precision));
        Simulation<D> simulation(brick<D>(spacings<D>(), jitter),
                                 make_material<D>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                                 {.support_dx = support, .pair_precision = precision});
        const Mat<D> F = some_gradient<D>();
        const Vec<D> shift = Vec<D>::LinSpaced(0.1, 0.3);
        simulation.set_displacement([&](const Vec<D>& X) { return Vec<D>(F * X - X + shift); });
        simulation.prepare();
        double error = 0;
        for (std::size_t i = 0; i < simulation.size(); ++i)
          error = std::max(error, (simulation.deformation_gradient(i) - F).cwiseAbs().maxCoeff());
        CHECK(error < 1e-12);
      }
}

TEST_CASE_TEMPLATE("patch test: a rigid motion makes no force", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  constexpr double E = 1e6;
  for (const double jitter : {0.0, 0.15})
    for (const auto precision : precisions)
      for (const char* name : {"st_venant_kirchhoff", "corotated_svk", "neo_hookean"})
        for (const auto plane : {Plane::strain, Plane::stress}) {
          if (D != 2 && plane == Plane::stress) continue;
          CAPTURE(jitter);
          CAPTURE(name);
          const auto cloud = brick<D>(spacings<D>(), jitter);
          Bare<D> body(cloud, make_material<D>(name, {.E = E, .nu = 0.3, .density = 1000, .plane = plane}),
                       {.pair_precision = precision});
          for (const double degrees : {0.0, 1.0, 30.0, 90.0, 137.0, 180.0, 300.0}) {
            CAPTURE(degrees);
            const Mat<D> R = rotation<D>(degrees * std::numbers::pi / 180);
            body.place([&](const Vec<D>& X) { return Vec<D>(R * X + Vec<D>::Constant(0.5)); });
            double largest = 0;
            for (const auto& f : body.forces()) largest = std::max(largest, f.norm());
            // F is a rotation to round-off, so the stresses are round-off of E: 1.4e-14 at the most when this
            // was written.
            CHECK(largest < 1e-13 * E * std::pow(cloud.dx, D - 1));
          }
        }
}
TEST_CASE_TEMPLATE("patch test: linear_elastic, for contrast, resists a rotation", Dimension, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  Bare<D> body(brick<D>(4), make_material<D>("linear_elastic", {.E = 1e6, .nu = 0.3, .density = 1000}), {});
  body.place([](const Vec<D>& X) { return Vec<D>(rotation<D>(0.5) * X); });
  double largest = 0;
  for (const auto& f : body.forces()) largest = std::max(largest, f.norm());
  CHECK(largest > 1e3);
}

TEST_CASE_TEMPLATE("patch test: a constant stress makes the tractions of the faces and no force inside",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(spacings<D>() / 2 * 2);
  Bare<D> body(cloud, make_material<D>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
               {.pair_precision = PairPrecision::double_precision});
  const Mat<D> F = some_gradient<D>();
  body.place([&](const Vec<D>& X) { return Vec<D>(F * X); });
  const auto forces = body.forces();
  const Mat<D> P = body.formulation->first_piola_kirchhoff(0);
  const double scale = P.norm() * std::pow(cloud.dx, D - 1);
  REQUIRE(P.norm() > 1e4);
  for (Index i = 0; i < body.n(); ++i) {
    // Where faces meet, particles see less than half of a lattice, and only nearly as much to both sides.
    const Vec<D> X = body.X(i);
    int faces = 0;
    for (int d = 0; d < D; ++d) faces += std::min(X[d], (d == 0 ? 1.5 : 1.0) - X[d]) < 1.5 * cloud.dx;
    const Vec<D> traction = -P * body.particles.B[static_cast<std::size_t>(i)];
    CHECK((forces[static_cast<std::size_t>(i)] - traction).norm() < (faces > 1 ? 1e-4 : 1e-12) * scale);
  }
}

TEST_CASE_TEMPLATE("forces are minus the derivative of the strain energy", Dimension, Dim<1>, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  for (const char* operators : {"standard", "corrected"})
    for (const char* name : {"linear_elastic", "st_venant_kirchhoff", "neo_hookean"})
      for (const auto precision : precisions) {
        CAPTURE(operators);
        CAPTURE(name);
        const auto cloud = brick<D>(D == 1 ? 30 : 6, 0.15);
        Bare<D> body(cloud, make_material<D>(name, {.E = 1e6, .nu = 0.3, .density = 1000}),
                     {.operators = operators, .pair_precision = precision});
        body.place([](const Vec<D>& X) { return Vec<D>(X + wavy<D>(X, 0.05)); });
        check_derivative(body, cloud.dx, D == 3 ? 37 : 3);
      }
}
