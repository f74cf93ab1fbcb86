#include <doctest/doctest.h>

#include <cmath>
#include <taut/boundary/constraints.hpp>
#include <taut/boundary/loads.hpp>
#include <taut/boundary/mirror.hpp>

using namespace taut;

TEST_CASE("constraints hold displacements, velocities and accelerations of their components") {
  Field X(3, 2), u(3, 2), v(3, 2), a(3, 2);
  for (Index i = 0; i < 3; ++i) {
    X.set_vec<2>(i, {1.0 * i, 2.0 * i});
    u.set_vec<2>(i, {9, 9});
    v.set_vec<2>(i, {7, 7});
    a.set_vec<2>(i, {5, 5});
  }
  Constraints<2> constraints;
  constraints.fix({0}, 1);
  constraints.prescribe({2}, 0, [](const Vec<2>& at, double t) { return at[1] * t * t; });
  const double t = 0.5;
  constraints.apply_to_displacements(t, X, u);
  constraints.apply_to_velocities(t, X, v, 1e-6);
  constraints.apply_to_accelerations(a);
  CHECK(u.vec<2>(0) == Vec<2>(9, 0));
  CHECK(u.vec<2>(1) == Vec<2>(9, 9));
  CHECK(u.vec<2>(2) == Vec<2>(4 * 0.25, 9));
  CHECK(v.vec<2>(0) == Vec<2>(7, 0));
  CHECK(v.vec<2>(2)[0] == doctest::Approx(2 * 4 * t));
  CHECK(a.vec<2>(0) == Vec<2>(5, 0));
  CHECK(a.vec<2>(1) == Vec<2>(5, 5));
  CHECK(a.vec<2>(2) == Vec<2>(0, 5));
}

TEST_CASE("loads divide by the mass, follow their histories and the ramp") {
  Field m(2, 1), a(2, 2);
  m.component(0)[0] = 2;
  m.component(0)[1] = 4;
  Loads<2> loads;
  loads.add({1}, {{8, -4}}, [](double t) { return t; });
  loads.add_body_force(2, {0, -10});
  loads.add_to(0.5, m, a);
  CHECK(a.vec<2>(0) == Vec<2>(0, -10));
  CHECK(a.vec<2>(1) == Vec<2>(1, -10.5));
  CHECK(loads.norm(0, m) == doctest::Approx(std::hypot(20.0, 40.0)));
  loads.set_ramp([](double) { return 0.5; });
  Field half(2, 2);
  loads.add_to(0.5, m, half);
  CHECK(half.vec<2>(1) == Vec<2>(0.5, -5.25));
}

TEST_CASE("mirror images stand where two planes put them, corner included") {
  const std::vector<Vec<2>> points = {{0, 0}, {1, 0}, {1, 2}, {5, 5}};
  const MirrorMap<2> mirror({{0, 0.0, 0}, {1, 0.0, 0}}, {}, points, 3.0, 1e-9);
  // (1,0): across x. (1,2): across x, across y, across both. The point on both planes and the far one have
  // none.
  REQUIRE(mirror.size() == 4);
  CHECK(mirror.begin() == 4);
  Field x(8, 2), T(8, 4), s(8, 3);
  for (Index i = 0; i < 4; ++i) {
    x.set_vec<2>(i, points[static_cast<std::size_t>(i)]);
    for (int c = 0; c < 4; ++c) T.component(c)[i] = 10 * i + c + 1;
    for (int c = 0; c < 3; ++c) s.component(c)[i] = 10 * i + c + 1;
  }
  Field v = x;
  mirror.positions(x);
  mirror.vectors(v);
  mirror.tensors(T);
  mirror.symmetric(s);
  int corner = 0;
  for (Index k = 0; k < mirror.size(); ++k) {
    const Vec<2> master = points[static_cast<std::size_t>(mirror.master(k))], image = x.vec<2>(4 + k);
    CHECK(image.cwiseAbs() == master.cwiseAbs());
    CHECK(image != master);
    CHECK(v.vec<2>(4 + k) == image);
    const double sx = image[0] < 0 ? -1 : 1, sy = image[1] < 0 ? -1 : 1;
    corner += sx < 0 && sy < 0;
    const double base = 10.0 * mirror.master(k);
    CHECK(T.component(0)[4 + k] == base + 1);
    CHECK(T.component(1)[4 + k] == sx * sy * (base + 2));
    CHECK(T.component(2)[4 + k] == sx * sy * (base + 3));
    CHECK(s.component(2)[4 + k] == sx * sy * (base + 3));
  }
  CHECK(corner == 1);
}

TEST_CASE("a plane away from the origin reflects about itself") {
  const std::vector<Vec<1>> points = {Vec<1>(0.7)};
  const MirrorMap<1> mirror({{0, 1.0, 1}}, {}, points, 0.5, 1e-9);
  REQUIRE(mirror.size() == 1);
  CHECK(mirror.image(0, points[0])[0] == doctest::Approx(1.3));
}
