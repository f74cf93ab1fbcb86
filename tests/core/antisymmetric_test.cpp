// The antisymmetric operator: nearly closed and exact, with vectors of corrected's form.
#include <doctest/doctest.h>
#include <omp.h>

#include <taut/base/error.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D>
Cloud<D> block(double dx, double jitter) {
  return make_cloud(box<D>(Vec<D>::Zero(), Vec<D>::Ones()), {.dx = dx, .jitter = jitter});
}

template <int D>
void check_properties(double dx, double jitter) {
  CAPTURE(D);
  const Method method{.operators = "antisymmetric", .pair_precision = PairPrecision::double_precision};
  const Discretised<D> b(block<D>(dx, jitter), method);
  CHECK(b.op.adjoint_d.empty());
  double linear = 0;
  bool antisymmetric = true;
  for (Index a = 0; a < b.particles.n; ++a) {
    Mat<D> sum = Mat<D>::Zero();
    b.pairs.for_each(a, [&](Index c, std::int64_t k, int lane) {
      sum += (b.X(c) - b.X(a)) * b.op.vector(k, lane).transpose();
      b.pairs.for_each(c, [&](Index back, std::int64_t kb, int lb) {
        if (back == a) antisymmetric = antisymmetric && b.op.vector(k, lane) == -b.op.vector(kb, lb);
      });
    });
    linear = std::max(linear, (sum * b.op.M.template mat<D>(a).transpose() - Mat<D>::Identity()).norm());
  }
  CHECK(linear < 1e-12);
  CHECK(antisymmetric);
  const Discretised<D> corrected(
      block<D>(dx, jitter), {.operators = "corrected", .pair_precision = PairPrecision::double_precision});
  CHECK(closure_error(b) < 0.1 * closure_error(corrected));
}

}  // namespace

TEST_CASE("antisymmetric operators are linearly exact, all but closed, and antisymmetric to the last bit") {
  check_properties<1>(0.05, 0.15);
  check_properties<2>(0.05, 0.15);
  check_properties<3>(0.1, 0.15);
}

TEST_CASE("antisymmetric operators take the memory of corrected ones, compatible ones more") {
  const auto bytes = [](const char* operators) {
    const Bare<3> body(block<3>(0.1, 0.15),
                       make_material<3>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                       Method{.operators = operators});
    return body.formulation->bytes();
  };
  CHECK(bytes("antisymmetric") == bytes("corrected"));
  CHECK(bytes("compatible") > bytes("corrected"));
}

TEST_CASE("antisymmetric operators bend a jittered cantilever right") {
  const double error = tip_error(jittered_cantilever(), "antisymmetric");
  MESSAGE("tip error " << error);
  CHECK(std::abs(error) < 0.04);
}

TEST_CASE("antisymmetric operators keep momentum and energy of a free vibration") {
  Simulation<2> body(make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1, .jitter = 0.15}),
                     make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                     Method{.operators = "antisymmetric"});
  body.set_velocity([](const Vec<2>& X) -> Vec<2> {
    return {0.3 + 0.5 * std::sin(3 * X.y()), 0.4 * std::cos(4 * X.x())};
  });
  check_free_vibration(body);
}

TEST_CASE(
    "antisymmetric operators have the same bits for one and two threads, next to a symmetry plane as well") {
  const int before = omp_get_max_threads();
  std::vector<Field> accelerations;
  for (const int threads : {1, 2}) {
    omp_set_num_threads(threads);
    Bare<3> body(block<3>(1.0 / 17, 0.15),
                 make_material<3>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                 Method{.operators = "antisymmetric"}, {{0, 0.0, 0}});
    for (Index i = 0; i < body.n(); ++i)
      body.particles.u.set_vec<3>(i, 0.02 * body.X(i).cwiseProduct(body.X(i)));
    body.formulation->update_accelerations(0);
    accelerations.push_back(body.particles.a);
  }
  omp_set_num_threads(before);
  CHECK(std::equal(accelerations[0].flat().begin(), accelerations[0].flat().end(),
                   accelerations[1].flat().begin()));
}

TEST_CASE("antisymmetric operators need areas, and vectors that are stored") {
  const auto make = [](Cloud<2> cloud, PairPrecision precision) {
    const Bare<2> body(cloud, make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}),
                       Method{.operators = "antisymmetric", .pair_precision = precision});
  };
  Cloud<2> bare = block<2>(0.1, 0.1);
  bare.B.clear();
  CHECK_THROWS_WITH_AS(make(bare, PairPrecision::automatic), doctest::Contains("boundary area"), InputError);
  CHECK_THROWS_WITH_AS(make(block<2>(0.1, 0.1), PairPrecision::shared),
                       doctest::Contains("the pair vectors of antisymmetric operators cannot be shared"),
                       InputError);
}
