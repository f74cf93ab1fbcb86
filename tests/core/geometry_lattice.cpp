#include <doctest/doctest.h>
#include <omp.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <taut/base/error.hpp>
#include <taut/geometry/geometry.hpp>
#include <tuple>

using std::numbers::pi;
using taut::Cloud;
using taut::InputError;
using taut::Lattice;
using taut::LatticeOptions;
using taut::Mat;
using taut::Shape;
using taut::Vec;

namespace {

LatticeOptions with(double dx, double jitter = 0, Lattice lattice = Lattice::node_centred) {
  LatticeOptions o;
  o.dx = dx;
  o.jitter = jitter;
  o.lattice = lattice;
  return o;
}

template <int D>
double volume(const Cloud<D>& c) {
  return std::accumulate(c.V.begin(), c.V.end(), 0.0);
}

// sum B = 0 and sum X (x) B = (sum V) I, which the compatible operators need to exist.
template <int D>
void check_closed(const Cloud<D>& c) {
  REQUIRE(c.B.size() == c.size());
  REQUIRE(c.V.size() == c.size());
  Vec<D> sum = Vec<D>::Zero();
  Mat<D> moment = Mat<D>::Zero();
  double area = 0, reach = 0;
  bool positive = true;
  for (std::size_t p = 0; p < c.size(); ++p) {
    positive &= c.V[p] > 0;
    sum += c.B[p];
    moment += c.X[p] * c.B[p].transpose();
    area += c.B[p].norm();
    reach = std::max(reach, c.X[p].norm());
  }
  CHECK(positive);
  CHECK(area > 0);
  CHECK(sum.norm() < 1e-13 * area);
  CHECK((moment - volume(c) * Mat<D>::Identity()).norm() < 1e-13 * area * reach);
}

template <int D>
bool same(const Cloud<D>& a, const Cloud<D>& b) {
  return a.X == b.X && a.V == b.V && a.B == b.B && a.extra == b.extra && a.dx == b.dx;
}

template <int D>
bool before(const Vec<D>& a, const Vec<D>& b) {
  for (int d = D - 1; d > 0; --d)
    if (a[d] != b[d]) return a[d] < b[d];
  return a[0] < b[0];
}

const Shape<2> l_shape = taut::box<2>({0, 0}, {6, 3}) | taut::box<2>({0, 0}, {3, 10});

}  // namespace

TEST_CASE("a node-centred square: particles on the faces, tributary volumes, area vectors") {
  const Cloud<2> c = taut::make_cloud(taut::box<2>({0, 0}, {1, 0.5}), with(0.25));
  REQUIRE(c.size() == 15);
  CHECK(c.dx == 0.25);
  CHECK(c.extra.empty());
  CHECK(c.X[0] == Vec<2>(0, 0));
  CHECK(c.X[1] == Vec<2>(0.25, 0));  // x fastest
  CHECK(c.X[14] == Vec<2>(1, 0.5));
  CHECK(c.V[0] == doctest::Approx(1.0 / 64));
  CHECK(c.V[1] == doctest::Approx(1.0 / 32));
  CHECK(c.V[6] == doctest::Approx(1.0 / 16));
  CHECK(c.B[0].isApprox(Vec<2>(-0.125, -0.125)));
  CHECK(c.B[1].isApprox(Vec<2>(0, -0.25)));
  CHECK(c.B[9].isApprox(Vec<2>(0.25, 0)));
  CHECK(c.B[6] == Vec<2>(0, 0));
  CHECK(volume(c) == doctest::Approx(0.5).epsilon(1e-14));
  check_closed(c);
}

TEST_CASE("a bar in one dimension has unit area vectors at its ends") {
  const Cloud<1> c = taut::make_cloud(taut::box<1>(Vec<1>(-1.0), Vec<1>(1.0)), with(0.1));
  REQUIRE(c.size() == 21);
  CHECK(c.B.front()[0] == doctest::Approx(-1));
  CHECK(c.B.back()[0] == doctest::Approx(1));
  CHECK(c.B[10][0] == 0);
  CHECK(c.V.front() == doctest::Approx(0.05));
  CHECK(volume(c) == doctest::Approx(2).epsilon(1e-14));
  check_closed(c);
}

TEST_CASE("a cube's corner, edge and face nodes") {
  const Cloud<3> c = taut::make_cloud(taut::box<3>({0, 0, 0}, {1, 1, 1}), with(0.5));
  REQUIRE(c.size() == 27);
  CHECK(c.V[0] == doctest::Approx(1.0 / 64));
  CHECK(c.V[13] == doctest::Approx(1.0 / 8));
  CHECK(c.B[0].isApprox(Vec<3>(-1, -1, -1) / 16));
  CHECK(c.B[1].isApprox(Vec<3>(0, -1, -1) / 8));
  CHECK(c.B[4].isApprox(Vec<3>(0, 0, -1) / 4));
  CHECK(c.B[13] == Vec<3>(0, 0, 0));
  check_closed(c);
}

TEST_CASE("a re-entrant corner has the area of the faces that meet there") {
  const Cloud<2> c = taut::make_cloud(l_shape, with(1));
  CHECK(volume(c) == doctest::Approx(39).epsilon(1e-14));
  bool found = false;
  for (std::size_t p = 0; p < c.size(); ++p)
    if (c.X[p] == Vec<2>(3, 3)) {
      found = true;
      CHECK(c.V[p] == doctest::Approx(0.75));
      CHECK(c.B[p].isApprox(Vec<2>(0.5, 0.5)));
    }
  CHECK(found);
}

TEST_CASE("sums of volumes and area vectors hold for every shape, jittered or not") {
  for (const double jitter : {0.0, 0.15, 0.4})
    for (const int samples : {1, 3}) {
      CAPTURE(jitter);
      CAPTURE(samples);
      LatticeOptions o = with(0.21, jitter);
      o.samples = samples;
      check_closed(taut::make_cloud(taut::box<1>(Vec<1>(-0.3), Vec<1>(2.0)), o));
      check_closed(taut::make_cloud(taut::ring<1>(Vec<1>(0.5), 1, 3), o));
      check_closed(taut::make_cloud(taut::box<2>({-0.3, 0.1}, {2, 1}), o));
      check_closed(taut::make_cloud(taut::sphere<2>({0.3, 0.4}, 1.3), o));
      check_closed(taut::make_cloud(taut::ring<2>({0.3, 0.4}, 0.9, 2), o));
      check_closed(taut::make_cloud(l_shape - taut::sphere<2>({1.5, 1.5}, 1), o));
      check_closed(taut::make_cloud(taut::box<3>({0, 0, 0}, {1, 0.7, 1.3}), o));
      check_closed(taut::make_cloud(taut::sphere<3>({5, 6, 7}, 1.1), o));
      check_closed(taut::make_cloud(taut::ring<3>({0, 0, 0}, 0.6, 1.2), o));
      check_closed(taut::make_cloud(taut::cylinder({0, 0, 0}, {1, 1, 0.3}, 0.6), o));
      const auto gyroid = [](const Vec<3>& X) {
        return std::sin(3 * X[0]) * std::cos(3 * X[1]) + std::sin(3 * X[1]) * std::cos(3 * X[2]) +
               std::sin(3 * X[2]) * std::cos(3 * X[0]);
      };
      check_closed(taut::make_cloud(taut::implicit<3>(gyroid, {0, 0, 0}, {2, 2, 2}), o));
    }
}

TEST_CASE("volumes of round bodies converge, and faster with more samples in a cell") {
  const auto error = [](double dx, int samples) {
    LatticeOptions o = with(dx);
    o.samples = samples;
    return std::abs(volume(taut::make_cloud(taut::sphere<2>({0.1, 0.2}, 1), o)) / pi - 1);
  };
  CHECK(error(0.1, 1) < 2e-2);
  CHECK(error(0.01, 1) < 1e-3);
  CHECK(error(0.1, 8) < 2e-3);
  CHECK(error(0.1, 8) < error(0.1, 1));
  CHECK(volume(taut::make_cloud(taut::cylinder({0, 0, 0}, {0, 0, 2}, 1), with(0.05))) ==
        doctest::Approx(2 * pi).epsilon(1e-2));
}

TEST_CASE("samples weigh a cell by the part that is inside") {
  // x < 0.6 leaves the second of four cells, [0.5, 1], with one sample in five.
  const auto f = [](const Vec<1>& X) { return X[0] - 0.6; };
  LatticeOptions o = with(0.5);
  o.samples = 5;
  const Cloud<1> c = taut::make_cloud(taut::implicit<1>(f, Vec<1>(0.0), Vec<1>(2.0)), o);
  REQUIRE(c.size() == 3);
  CHECK(c.V[0] == doctest::Approx(0.25));
  CHECK(c.V[1] == doctest::Approx(0.3));
  CHECK(c.V[2] == doctest::Approx(0.05));
}

TEST_CASE("an axis that the spacing does not divide gets a rounded number of cells") {
  const Cloud<2> c = taut::make_cloud(taut::box<2>({0, 0}, {1, 0.7}), with(0.3));
  CHECK(c.size() == 4 * 3);
  CHECK(c.X[1][0] == doctest::Approx(1.0 / 3));
  CHECK(c.X[4][1] == doctest::Approx(0.35));
  CHECK(c.X.back() == Vec<2>(1, 0.7));
  CHECK(c.dx == doctest::Approx(std::sqrt(0.35 / 3)));
  CHECK(volume(c) == doctest::Approx(0.7).epsilon(1e-14));
  check_closed(c);
}

TEST_CASE("the order is lexicographic and the lattice of a mirrored body is mirrored to the bit") {
  for (const Lattice lattice : {Lattice::node_centred, Lattice::cell_centred}) {
    const Cloud<3> c = taut::make_cloud(taut::ring<3>({0, 0, 0}, 0.3, 0.7), with(0.1 / 3, 0, lattice));
    for (std::size_t p = 1; p < c.size(); ++p) REQUIRE(before<3>(c.X[p - 1], c.X[p]));
    for (std::size_t p = 0; p < c.size(); ++p) {
      REQUIRE(c.X[p] == -c.X[c.size() - 1 - p]);
      REQUIRE(c.V[p] == c.V[c.size() - 1 - p]);
    }
  }
}

TEST_CASE("cell-centred lattices have equal volumes half a spacing from the faces") {
  const Cloud<2> c = taut::make_cloud(taut::box<2>({1, 2}, {2, 2.5}), with(0.1, 0, Lattice::cell_centred));
  REQUIRE(c.size() == 50);
  CHECK(c.B.empty());
  CHECK(c.X[0].isApprox(Vec<2>(1.05, 2.05)));
  CHECK(c.X[49].isApprox(Vec<2>(1.95, 2.45)));
  for (const double v : c.V) CHECK(v == c.V[0]);
  CHECK(volume(c) == doctest::Approx(0.5).epsilon(1e-14));
  CHECK(taut::make_cloud(l_shape, with(1, 0, Lattice::cell_centred)).size() == 39);
}

TEST_CASE("jitter moves interior points only, within its bound, the same way every time") {
  for (const Lattice lattice : {Lattice::node_centred, Lattice::cell_centred}) {
    const Shape<3> body = taut::box<3>({0, 0, 0}, {1, 0.8, 0.6});
    const Cloud<3> still = taut::make_cloud(body, with(0.1, 0, lattice));
    LatticeOptions o = with(0.1, 0.15, lattice);
    const Cloud<3> moved = taut::make_cloud(body, o);
    CHECK(same(moved, taut::make_cloud(body, o)));
    REQUIRE(moved.size() == still.size());
    CHECK(moved.V == still.V);
    CHECK(moved.B == still.B);

    const double rim = lattice == Lattice::node_centred ? 0.05 : 0.1;
    double largest = 0;
    Vec<3> mean = Vec<3>::Zero();
    int interior = 0;
    for (std::size_t p = 0; p < still.size(); ++p) {
      const Vec<3> d = moved.X[p] - still.X[p];
      const bool inside = (still.X[p].array() > body.min().array() + rim).all() &&
                          (still.X[p].array() < body.max().array() - rim).all();
      CHECK((d.norm() > 0) == inside);
      CHECK(d.cwiseAbs().maxCoeff() <= 0.015 * (1 + 1e-9));
      largest = std::max(largest, d.cwiseAbs().maxCoeff());
      mean += d;
      interior += inside;
    }
    CHECK(largest > 0.014);                                             // the whole range is used …
    CHECK((mean / interior).norm() < 4 * 0.015 / std::sqrt(interior));  // … evenly
    o.seed = 2;
    CHECK_FALSE(same(moved, taut::make_cloud(body, o)));
  }
}

TEST_CASE("jitter has the same bits on every machine") {
  const Cloud<2> c = taut::make_cloud(taut::box<2>({0, 0}, {2, 2}), with(1, 0.25));
  REQUIRE(c.size() == 9);
  CHECK(c.X[4][0] == doctest::Approx(0.8723194417060985).epsilon(1e-15));
  CHECK(c.X[4][1] == doctest::Approx(1.0241169891230553).epsilon(1e-15));
}

TEST_CASE("clouds do not depend on the number of threads") {
  const Shape<3> body = taut::ring<3>({0, 0, 0}, 0.5, 1);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const Cloud<3> one = taut::make_cloud(body, with(0.1, 0.2));
  omp_set_num_threads(3);
  const Cloud<3> three = taut::make_cloud(body, with(0.1, 0.2));
  omp_set_num_threads(threads);
  CHECK(same(one, three));
}

TEST_CASE("layers go on beyond the faces without moving the body's own particles") {
  const Shape<2> body = taut::box<2>({0, 0}, {1, 0.4});
  for (const double jitter : {0.0, 0.1}) {
    LatticeOptions o = with(0.1, jitter, Lattice::cell_centred);
    const Cloud<2> plain = taut::make_cloud(body, o);
    o.layers[0] = {3, 0};
    o.layers[1] = {0, 2};
    const Cloud<2> c = taut::make_cloud(body, o);
    REQUIRE(c.size() == 13 * 6);
    REQUIRE(c.extra.size() == c.size());
    CHECK(c.X[0].isApprox(Vec<2>(-0.25, 0.05)));
    CHECK(c.X.back().isApprox(Vec<2>(0.95, 0.55)));
    std::size_t own = 0;
    for (std::size_t p = 0; p < c.size(); ++p) {
      CHECK(bool(c.extra[p]) == (c.X[p][0] < 0 || c.X[p][1] > 0.4));
      CHECK(c.V[p] == c.V[0]);
      if (c.extra[p]) continue;
      if (jitter == 0) CHECK(c.X[p] == plain.X[own]);
      ++own;
    }
    CHECK(own == plain.size());
  }
}

TEST_CASE("layers of a node-centred lattice belong to one longer body") {
  LatticeOptions o = with(0.1);
  o.layers[0] = {0, 2};
  const Cloud<2> c = taut::make_cloud(taut::box<2>({0, 0}, {1, 0.4}), o);
  CHECK(c.size() == 13 * 5);
  CHECK(std::count(c.extra.begin(), c.extra.end(), 1) == 2 * 5);
  CHECK(volume(c) == doctest::Approx(0.48).epsilon(1e-14));
  check_closed(c);
}

TEST_CASE("layers carry on the cross-section of any shape") {
  LatticeOptions o = with(0.5, 0, Lattice::cell_centred);
  o.layers[1] = {0, 4};
  const Cloud<2> c = taut::make_cloud(l_shape, o);
  // The leg [0, 3] reaches y = 10, the foot does not.
  CHECK(volume(c) == doctest::Approx(39 + 3 * 2).epsilon(1e-14));
  for (std::size_t p = 0; p < c.size(); ++p)
    if (c.extra[p]) CHECK((c.X[p][0] < 3 && c.X[p][1] > 10));
}

TEST_CASE("faces are selected within a quarter spacing") {
  const Cloud<3> c = taut::make_cloud(taut::box<3>({0, 0, 0}, {1, 0.5, 0.5}), with(0.25, 0.4));
  const auto count = [](const auto& cloud, std::string_view face) {
    return std::count_if(cloud.X.begin(), cloud.X.end(), taut::on_face(cloud, face));
  };
  CHECK(count(c, "x_min") == 9);
  CHECK(count(c, "x_max") == 9);
  CHECK(count(c, "y_min") == 15);
  CHECK(count(c, "z_max") == 15);
  CHECK(taut::on_face(c, "x_max")({1, 0.1, 0.1}));
  CHECK_FALSE(taut::on_face(c, "x_max")({0.9, 0.1, 0.1}));

  LatticeOptions o = with(0.25, 0, Lattice::cell_centred);
  const Shape<2> body = taut::box<2>({0, 0}, {1, 0.5});
  CHECK(count(taut::make_cloud(body, o), "x_min") == 2);
  CHECK(count(taut::make_cloud(body, o), "y_max") == 4);
  o.layers[0] = {2, 0};
  CHECK(taut::on_face(taut::make_cloud(body, o), "x_min")({0.125, 0}));  // the body's own, not a layer's

  const Cloud<1> bar = taut::make_cloud(taut::box<1>(Vec<1>(0.0), Vec<1>(1.0)), with(0.5));
  CHECK(count(bar, "x_max") == 1);
  CHECK_THROWS_WITH_AS(taut::on_face(bar, "y_min"), "unknown face \"y_min\"; valid in 1D: x_min, x_max",
                       InputError);
  CHECK_THROWS_WITH_AS(taut::on_face(c, "left"),
                       "unknown face \"left\"; valid in 3D: x_min, x_max, y_min, y_max, z_min, z_max",
                       InputError);
  CHECK_THROWS_WITH_AS(taut::on_face(Cloud<2>{}, "x_min"), "face x_min of an empty cloud", InputError);
}

TEST_CASE("lattices that cannot be are refused") {
  const Shape<2> body = taut::box<2>({0, 0}, {1, 0.1});
  const auto fails = [&](const LatticeOptions& o) { CHECK_THROWS_AS(taut::make_cloud(body, o), InputError); };
  for (const double dx : {0.0, -0.1, std::nan(""), std::numeric_limits<double>::infinity()}) fails(with(dx));
  CHECK_THROWS_WITH_AS(taut::make_cloud(body, with(0.5)),
                       "make_cloud: spacing 0.5 is larger than the body, which is 0.1 long along y",
                       InputError);
  CHECK(taut::make_cloud(body, with(0.1)).size() == 22);
  fails(with(0.1, -0.1));
  fails(with(0.1, 0.41));
  fails(with(0.1, std::nan("")));
  fails(with(1e-6));  // 10^11 cells
  fails(with(1e-300));
  LatticeOptions o = with(0.1);
  o.layers[0][1] = -1;
  fails(o);
  o.layers = {};
  o.layers[2][0] = 1;
  CHECK_THROWS_WITH_AS(taut::make_cloud(body, o), "make_cloud: layers along z in 2D", InputError);
  o.layers = {};
  o.layers[0][0] = std::numeric_limits<int>::max();
  fails(o);
  o = with(0.1);
  for (const int samples : {0, -1, 17}) {
    o.samples = samples;
    fails(o);
  }
  const auto nothing = [](const Vec<2>&) { return 1.0; };
  CHECK_THROWS_WITH_AS(taut::make_cloud(taut::implicit<2>(nothing, {0, 0}, {1, 1}), with(0.1)),
                       "make_cloud: the body is empty: no cell of a lattice of spacing 0.1 is inside",
                       InputError);
}

TEST_CASE("what a shape's function throws comes out") {
  const auto broken = [](const Vec<2>&) -> double { throw std::runtime_error("no such level set"); };
  CHECK_THROWS_WITH(taut::make_cloud(taut::implicit<2>(broken, {0, 0}, {1, 1}), with(0.1)),
                    "no such level set");
}
