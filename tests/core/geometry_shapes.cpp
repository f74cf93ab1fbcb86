#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <taut/base/error.hpp>
#include <taut/geometry/geometry.hpp>

using taut::InputError;
using taut::Shape;
using taut::Vec;

TEST_CASE("boxes contain their faces") {
  const Shape<2> b = taut::box<2>({0, -1}, {2, 1});
  CHECK(b.contains({1, 0}));
  CHECK(b.contains({0, -1}));
  CHECK(b.contains({2, 1}));
  CHECK_FALSE(b.contains({2.001, 0}));
  CHECK_FALSE(b.contains({1, -1.001}));
  CHECK(b.min() == Vec<2>(0, -1));
  CHECK(b.max() == Vec<2>(2, 1));
}

TEST_CASE("spheres and rings") {
  const Shape<1> interval = taut::sphere<1>(Vec<1>(1.0), 0.5);
  CHECK(interval.contains(Vec<1>(0.6)));
  CHECK_FALSE(interval.contains(Vec<1>(0.4)));
  const Shape<3> ball = taut::sphere<3>({1, 2, 3}, 2);
  CHECK(ball.contains({2.1, 3.1, 4.1}));
  CHECK_FALSE(ball.contains({2.2, 3.2, 4.2}));
  CHECK(ball.min() == Vec<3>(-1, 0, 1));
  CHECK(ball.max() == Vec<3>(3, 4, 5));
  const Shape<2> annulus = taut::ring<2>({0, 0}, 0.5, 1);
  CHECK(annulus.contains({0.5, 0}));
  CHECK(annulus.contains({0, -1}));
  CHECK_FALSE(annulus.contains({0.3, 0.3}));
  CHECK_FALSE(annulus.contains({0.8, 0.8}));
}

TEST_CASE("cylinders along any direction have a tight box") {
  const Shape<3> upright = taut::cylinder({0, 0, -1}, {0, 0, 2}, 0.5);
  CHECK(upright.min() == Vec<3>(-0.5, -0.5, -1));
  CHECK(upright.max() == Vec<3>(0.5, 0.5, 2));
  CHECK(upright.contains({0.3, 0.3, 1.9}));
  CHECK_FALSE(upright.contains({0.4, 0.4, 1.9}));
  CHECK_FALSE(upright.contains({0, 0, 2.1}));
  // 45 degrees in the xy plane
  const Shape<3> tilted = taut::cylinder({0, 0, 0}, {3, 3, 0}, 1);
  CHECK(tilted.min()[0] == doctest::Approx(-std::sqrt(0.5)));
  CHECK(tilted.max()[1] == doctest::Approx(3 + std::sqrt(0.5)));
  CHECK(tilted.max()[2] == doctest::Approx(1));
  CHECK(tilted.contains({0.7, -0.7, 0}));
  CHECK_FALSE(tilted.contains({-0.1, -0.1, 0}));
}

TEST_CASE("implicit regions stay within their box") {
  const auto f = [](const Vec<2>& X) { return X[1] - X[0] * X[0]; };
  const Shape<2> s = taut::implicit<2>(f, {-1, 0}, {1, 1});
  CHECK(s.contains({0.5, 0.2}));
  CHECK_FALSE(s.contains({0.5, 0.25}));
  CHECK_FALSE(s.contains({0.5, -0.2}));
  CHECK_FALSE(s.contains({2, 0.2}));
}

TEST_CASE("unions and differences") {
  const Shape<2> foot = taut::box<2>({0, 0}, {6, 3}), leg = taut::box<2>({0, 0}, {3, 10});
  const Shape<2> both = foot | leg;
  CHECK(both.max() == Vec<2>(6, 10));
  CHECK(both.contains({5, 1}));
  CHECK(both.contains({1, 9}));
  CHECK_FALSE(both.contains({5, 9}));
  const Shape<2> holed = both - taut::sphere<2>({1.5, 1.5}, 1);
  CHECK(holed.max() == Vec<2>(6, 10));
  CHECK_FALSE(holed.contains({1.5, 1.5}));
  CHECK(holed.contains({2.6, 1.5}));
}

TEST_CASE("impossible shapes are refused") {
  CHECK_THROWS_WITH_AS(taut::box<2>({0, 1}, {1, 1}), "shape: y_min = 1 is not less than y_max = 1",
                       InputError);
  CHECK_THROWS_WITH_AS(taut::box<3>({0, 0, std::nan("")}, {1, 1, 1}),
                       "shape: corner min: z = nan is not finite", InputError);
  CHECK_THROWS_AS(taut::box<1>(Vec<1>(0.0), Vec<1>(std::numeric_limits<double>::infinity())), InputError);
  CHECK_THROWS_WITH_AS(taut::sphere<2>({0, 0}, -1), "sphere: radius -1 is not positive and finite",
                       InputError);
  CHECK_THROWS_AS(taut::sphere<2>({0, std::nan("")}, 1), InputError);
  CHECK_THROWS_WITH_AS(taut::ring<2>({0, 0}, 2, 1), "ring: inner radius 2 is not less than outer radius 1",
                       InputError);
  CHECK_THROWS_AS(taut::ring<2>({0, 0}, 0, 1), InputError);
  CHECK_THROWS_AS(taut::ring<2>({0, 0}, 1, std::nan("")), InputError);
  CHECK_THROWS_WITH_AS(taut::cylinder({1, 1, 1}, {1, 1, 1}, 1), "cylinder: its two ends are the same point",
                       InputError);
  CHECK_THROWS_AS(taut::cylinder({0, 0, 0}, {1, 1, 1}, 0), InputError);
  CHECK_THROWS_AS(taut::implicit<2>({}, {0, 0}, {1, 1}), InputError);
  CHECK_THROWS_AS(taut::implicit<2>([](const Vec<2>&) { return -1.0; }, {0, 0}, {0, 1}), InputError);
  CHECK_THROWS_AS(Shape<2>({}, {0, 0}, {1, 1}), InputError);
}
