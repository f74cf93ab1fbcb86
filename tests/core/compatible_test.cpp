// The compatible operator: linear exactness, closure, conjugacy; and what they give on a jittered cloud.
#include <doctest/doctest.h>

#include <cmath>
#include <taut/taut.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D>
Discretised<D> build(double dx, double jitter, const Method& method) {
  return {make_cloud(box<D>(Vec<D>::Zero(), Vec<D>::Ones()), {.dx = dx, .jitter = jitter}), method};
}

template <int D>
void check_properties(double dx, double jitter) {
  CAPTURE(D);
  CAPTURE(jitter);
  Method method{.operators = "compatible",
                .pair_precision = PairPrecision::double_precision,
                .compatible_iterations = 4000};
  const auto b = build<D>(dx, jitter, method);
  double linear = 0;
  bool conjugate = true;
  for (Index a = 0; a < b.particles.n; ++a) {
    Mat<D> sum = Mat<D>::Zero();
    b.pairs.for_each(a, [&](Index c, std::int64_t k, int lane) {
      sum += (b.particles.X.template vec<D>(c) - b.particles.X.template vec<D>(a)) *
             vector_in<D>(b.op.vectors_d, k, lane).transpose();
      // -G_ba as stored with a is, bit for bit, minus G_ba as stored with b: momentum is kept to the last
      // bit.
      b.pairs.for_each(c, [&](Index back, std::int64_t kb, int lb) {
        if (back == a)
          conjugate =
              conjugate && vector_in<D>(b.op.adjoint_d, k, lane) == -vector_in<D>(b.op.vectors_d, kb, lb);
      });
    });
    linear = std::max(linear, (sum * b.op.M.template mat<D>(a).transpose() - Mat<D>::Identity()).norm());
  }
  CHECK(linear < 1e-12);
  CHECK(conjugate);
  // Solved to the end, a constant stress gives no force inside, and its traction on the boundary.
  CHECK(closure_error(b) < 1e-10);
}

}  // namespace

TEST_CASE("compatible operators are linearly exact, closed and conjugate on lattice and jitter") {
  for (const double jitter : {0.0, 0.15}) {
    check_properties<1>(0.05, jitter);
    check_properties<2>(0.1, jitter);
    check_properties<3>(0.2, jitter);
  }
}

TEST_CASE("the closure that early stopping leaves is far below that of corrected operators") {
  Method method{.operators = "corrected", .pair_precision = PairPrecision::double_precision};
  const double corrected = closure_error(build<2>(0.05, 0.15, method));
  method.operators = "compatible";
  method.compatible_iterations = Method().compatible_iterations;
  const double stopped = closure_error(build<2>(0.05, 0.15, method));
  MESSAGE("force of a unit stress over a cell's face: corrected " << corrected << ", compatible " << stopped);
  CHECK(corrected > 0.1);
  CHECK(stopped < 0.02 * corrected);
}

TEST_CASE("compatible operators bend a jittered cantilever right, where corrected ones do not") {
  CHECK(std::abs(tip_error(jittered_cantilever(), "compatible")) < 0.04);
  CHECK(std::abs(tip_error(jittered_cantilever(), "corrected")) > 0.2);
}

TEST_CASE("compatible operators keep momentum and energy of a free vibration") {
  Simulation<2> body(make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1, .jitter = 0.15}),
                     make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                     Method{.operators = "compatible", .pair_precision = PairPrecision::double_precision});
  body.set_velocity([](const Vec<2>& X) -> Vec<2> {
    return {0.3 + 0.5 * std::sin(3 * X.y()), 0.4 * std::cos(4 * X.x())};
  });
  check_free_vibration(body);
}

TEST_CASE("compatible operators refuse areas that do not enclose the body") {
  Cloud<2> cloud = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 0.2});
  for (auto& B : cloud.B) B *= -1;  // inward
  Simulation<2> body(std::move(cloud),
                     make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                     Method{.operators = "compatible"});
  CHECK_THROWS_WITH_AS(body.prepare(), doctest::Contains("do not enclose the body"), InputError);
}

TEST_CASE("compatible operators say that they need areas next to symmetry planes") {
  Cloud<2> bare = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 0.2, .lattice = Lattice::cell_centred});
  bare.facets.clear();
  Simulation<2> cells(bare, make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                      Method{.operators = "compatible"});
  cells.symmetry_plane(0, 0);
  CHECK_THROWS_WITH_AS(cells.prepare(), doctest::Contains("boundary area"), InputError);
}

TEST_CASE("compatible operators of a lattice that is all but closed stay corrected ones, shared") {
  const auto formulation_of = [](const char* operators, double support_dx, double jitter,
                                 PairPrecision precision) {
    return std::make_unique<Bare<3>>(
        make_cloud(box<3>({0.1, 0.7, -0.3}, {1.1, 1.3, 0.7}), {.dx = 0.1, .jitter = jitter}),
        make_material<3>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
        Method{.operators = operators, .support_dx = support_dx, .pair_precision = precision});
  };
  const auto accelerations = [](Bare<3>& body) {
    for (Index i = 0; i < body.n(); ++i) {
      const Vec<3> X = body.X(i);
      body.particles.u.set_vec<3>(i, 0.05 * Vec<3>(std::sin(2 * X.y()), std::cos(3 * X.z()), X.x() * X.y()));
    }
    body.formulation->update_accelerations(0);
    return body.particles.a;
  };
  const auto compatible = formulation_of("compatible", 1.5, 0, PairPrecision::automatic),
             corrected = formulation_of("corrected", 1.5, 0, PairPrecision::automatic),
             solved = formulation_of("compatible", 1.5, 0, PairPrecision::double_precision);
  CHECK(compatible->formulation->bytes() == corrected->formulation->bytes());
  CHECK(compatible->formulation->bytes() < 0.5 * static_cast<double>(solved->formulation->bytes()));
  const Field kept = accelerations(*compatible), exact = accelerations(*solved);
  double largest = 0, difference = 0;
  for (Index i = 0; i < compatible->n(); ++i) {
    largest = std::max(largest, exact.vec<3>(i).norm());
    difference = std::max(difference, (kept.vec<3>(i) - exact.vec<3>(i)).norm());
  }
  CHECK(difference > 0);
  CHECK(difference < 1e-4 * largest);
  // Wider supports feel the faces from further inside, and jitter leaves nothing closed.
  for (const auto& [support_dx, jitter] : {std::pair(2.4, 0.0), std::pair(1.5, 0.1)}) {
    CHECK(formulation_of("compatible", support_dx, jitter, PairPrecision::automatic)->formulation->bytes() >
          formulation_of("corrected", support_dx, jitter, PairPrecision::automatic)->formulation->bytes());
    for (const auto precision : {PairPrecision::shared, PairPrecision::recomputed})
      CHECK_THROWS_WITH_AS(formulation_of("compatible", support_dx, jitter, precision),
                           doctest::Contains("the pair vectors of compatible operators cannot be"),
                           InputError);
  }
}
