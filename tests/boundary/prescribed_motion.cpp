#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>
#include <taut/boundary/constraints.hpp>

using namespace taut;

namespace {

constexpr double window = 1e-3;
const Vec<2> X(2, 3);

// Refuses to be asked for what was before the start.
double started(double t) {
  if (t < 0) throw std::logic_error("before the start");
  return std::sin(t) + 0.5 * t * t;
}
double its_velocity(double t) { return std::cos(t) + t; }

}  // namespace

TEST_CASE("velocities of prescribed displacements are differences of fourth order that begin at t = 0") {
  const PrescribedMotion<2> all(started), each([](const Vec<2>&at, double t) { return at[0] * started(t); });
  for (const double t : {0.0, 1e-9, 0.3e-3, 1e-3, 1.7e-3, 2e-3, 5e-3, 1.0, 12345.678}) {
    CAPTURE(t);
    // What rounding the displacement leaves of a difference over a window.
    const double rounding = 4e-16 * (1 + started(t)) / window;
    CHECK(std::abs(all.velocity(t, window)(X) - its_velocity(t)) < 1e-12 + rounding);
    CHECK(std::abs(each.velocity(t, window)(X) / 2 - its_velocity(t)) < 1e-12 + rounding);
    CHECK(all.displacement(t)(X) == started(t));
    CHECK(each.displacement(t)(X) == 2 * started(t));
  }
}

TEST_CASE("displacements that stand still have no velocity, however large they are") {
  const PrescribedMotion<2> all([](double) { return 0.1; }),
      each([](const Vec<2>&at, double) { return at[1] / 3; });
  for (const double t : {0.0, 1e-4, 0.7})
    for (const double w : {1e-12, 1e-3}) {
      CHECK(all.velocity(t, w)(X) == 0);
      CHECK(each.velocity(t, w)(X) == 0);
    }
  CHECK(PrescribedMotion<2>().velocity(1, window)(X) == 0);
  CHECK(PrescribedMotion<2>().displacement(1)(X) == 0);
  CHECK_FALSE(PrescribedMotion<2>().moves());
  CHECK(all.moves());
}

TEST_CASE("velocities that are given are taken as they are") {
  const PrescribedMotion<2> all(started, [](double t) { return 7 * t; });
  const PrescribedMotion<2> each([](const Vec<2>&, double) { return 0.0; },
                                 [](const Vec<2>& at, double t) { return at[1] * t; });
  CHECK(all.velocity(2, window)(X) == 14);
  CHECK(each.velocity(2, window)(X) == 6);
  CHECK(each.seen_from({0, 10}).velocity(2, window)(X) == 26);
}

TEST_CASE("the history of a set is asked for once a time, not once a particle") {
  const Index n = 50;
  Field at(n, 2), u(n, 2), v(n, 2);
  std::vector<Index> everybody;
  for (Index i = 0; i < n; ++i) everybody.push_back(i);
  int asked = 0;
  Constraints<2> constraints;
  constraints.prescribe(everybody, 0, [&](double t) {
    ++asked;
    return 2 * t;
  });
  constraints.apply_to_displacements(3, at, u);
  CHECK(asked == 1);
  constraints.apply_to_velocities(3, at, v, window);
  CHECK(asked <= 5);
  CHECK(u.vec<2>(n - 1) == Vec<2>(6, 0));
  CHECK(v.vec<2>(n - 1)[0] == doctest::Approx(2).epsilon(1e-12));
}
