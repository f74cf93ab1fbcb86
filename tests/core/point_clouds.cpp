#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <taut/geometry/geometry.hpp>
#include <taut/geometry/spacing.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D>
double sum(const std::vector<double>& V) {
  double total = 0;
  for (const double v : V) total += v;
  return total;
}

template <int D>
void check_encloses(const Cloud<D>& cloud) {
  Vec<D> areas = Vec<D>::Zero();
  Mat<D> first = Mat<D>::Zero();
  double total = 0;
  for (const Facet<D>& f : cloud.facets) {
    areas += f.area;
    first += f.centre * f.area.transpose();
    total += f.area.norm();
  }
  const double volume = sum<D>(cloud.V);
  CHECK(areas.norm() < 1e-12 * total);
  CHECK((first - volume * Mat<D>::Identity()).norm() < 1e-12 * volume);
}

template <int D>
Vec<D> brick_size() {
  return Vec<3>(1.5, 1, 0.75).head<D>();
}

template <int D>
Cloud<D> bare_brick(Lattice lattice, double jitter = 0) {
  Cloud<D> cloud = make_cloud(box<D>(Vec<D>::Zero(), brick_size<D>()),
                              {.dx = 0.125, .lattice = lattice, .jitter = jitter, .seed = 5});
  cloud.B.clear();
  return cloud;
}

/// Every point moved by up to `amount` spacings along each axis, outermost ones too.
template <int D>
void shake(Cloud<D>& cloud, double amount) {
  std::mt19937 random(3);
  for (Vec<D>& x : cloud.X)
    for (int d = 0; d < D; ++d)
      x[d] += amount * cloud.dx * (static_cast<double>(random()) / 2147483648.0 - 1);
}

/// The axis along which, and the side on which, a facet of the brick lies; how far off that side it lies.
template <int D>
double off_the_brick(const Facet<D>& f) {
  int axis = 0;
  f.area.cwiseAbs().maxCoeff(&axis);
  return std::abs(f.centre[axis] - (f.area[axis] > 0 ? brick_size<D>()[axis] : 0));
}

template <int D>
double largest_difference(const std::vector<double>& V, const std::vector<double>& truth) {
  double largest = 0;
  for (std::size_t i = 0; i < V.size(); ++i) largest = std::max(largest, std::abs(V[i] / truth[i] - 1));
  return largest;
}

}  // namespace

TEST_CASE_TEMPLATE("volumes of lattice nodes are their cells', halved on faces", Dimension, Dim<1>, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  const Cloud<D> exact = bare_brick<D>(Lattice::node_centred);
  Cloud<D> cloud = exact;
  find_volumes(cloud);
  CHECK(largest_difference<D>(cloud.V, exact.V) < 1e-12);
  // Turned and far off, where coordinates are not round.
  for (Vec<D>& x : cloud.X) x = rotation<D>(0.4) * x + Vec<D>::Constant(300);
  find_volumes(cloud);
  CHECK(largest_difference<D>(cloud.V, exact.V) < 1e-9);
}

TEST_CASE_TEMPLATE("volumes of jittered nodes sum to the body and are near their cells'", Dimension, Dim<1>,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const Cloud<D> exact = bare_brick<D>(Lattice::node_centred, 0.25);
  Cloud<D> cloud = exact;
  find_volumes(cloud);
  const double volume = brick_size<D>().prod();
  CHECK(std::abs(sum<D>(cloud.V) - volume) < 1e-12 * volume);
  CHECK(largest_difference<D>(cloud.V, exact.V) < 0.6);
}

TEST_CASE("volumes of a notched body, a ring, two bodies") {
  const auto notched = box<2>({0, 0}, {1, 1}) - box<2>({0.5, 0.5}, {2, 2});
  Cloud<2> cloud = make_cloud(notched, {.dx = 0.05});
  find_volumes(cloud);
  // The re-entrant corner is cut off.
  CHECK(sum<2>(cloud.V) == doctest::Approx(0.75 + 0.5 * 0.05 * 0.05).epsilon(1e-12));

  Cloud<2> rings;
  const double pi = std::acos(-1.0);
  for (int k = 0; k <= 6; ++k)
    for (int i = 0; i < 90; ++i) {
      const double angle = 2 * pi * (i + 0.5 * (k % 2)) / 90, r = 1 - 0.07 * k;
      rings.X.push_back({r * std::cos(angle), r * std::sin(angle)});
    }
  find_volumes(rings);
  const double polygons = 45 * std::sin(2 * pi / 90) * (1 - 0.58 * 0.58);
  CHECK(sum<2>(rings.V) == doctest::Approx(polygons).epsilon(1e-12));

  Cloud<3> two = make_cloud(box<3>({0, 0, 0}, {0.5, 0.25, 0.25}) | box<3>({1, 0, 0}, {1.25, 0.25, 0.25}),
                            {.dx = 0.0625});
  find_volumes(two);
  CHECK(sum<3>(two.V) == doctest::Approx(0.75 * 0.0625).epsilon(1e-12));
}

TEST_CASE("volumes of cells that are long, slanted and graded") {
  // Cook's membrane: cells of 6 x 5.5 on the left, 6 x 2 on the right.
  Cloud<2> cloud;
  for (int i = 0; i <= 8; ++i)
    for (int j = 0; j <= 8; ++j) cloud.X.push_back({6.0 * i, 5.5 * i + j * (5.5 - 0.4375 * i)});
  find_volumes(cloud);
  CHECK(sum<2>(cloud.V) == doctest::Approx(1440).epsilon(1e-12));
}

TEST_CASE("points that are no body are refused by name") {
  Cloud<2> cloud = bare_brick<2>(Lattice::node_centred);
  cloud.X.emplace_back(3, 0.5);
  CHECK_THROWS_WITH_AS(find_volumes(cloud),
                       doctest::Contains("particle 117 at (3, 0.5) lies on no part of the body"), InputError);
  cloud.X.back() = cloud.X[7];
  CHECK_THROWS_WITH_AS(find_volumes(cloud), doctest::Contains("particle 7 at (0.875, 0) coincides"),
                       InputError);
  cloud.X.resize(2);
  CHECK_THROWS_WITH_AS(find_volumes(cloud), "2 point(s) do not enclose a body in 2D", InputError);
}

TEST_CASE_TEMPLATE("facets of cells' middles are the faces half a cell before them", Dimension, Dim<1>,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  Cloud<D> cloud = bare_brick<D>(Lattice::cell_centred);
  enclose_cloud(cloud);
  check_encloses(cloud);
  std::vector<double> side(2 * D, 0);
  std::vector<Vec<D>> own(cloud.size(), Vec<D>::Zero());
  for (const Facet<D>& f : cloud.facets) {
    int axis = 0;
    const double size = f.area.cwiseAbs().maxCoeff(&axis);
    CHECK(f.area.norm() - size < 1e-12 * size);
    CHECK(off_the_brick(f) < 1e-12);
    side[static_cast<std::size_t>(2 * axis + (f.area[axis] > 0))] += size;
    own[static_cast<std::size_t>(f.owner)] += f.area;
  }
  for (int d = 0; d < D; ++d)
    for (int k = 0; k < 2; ++k)
      CHECK(side[static_cast<std::size_t>(2 * d + k)] ==
            doctest::Approx(brick_size<D>().prod() / brick_size<D>()[d]).epsilon(1e-12));
  // Each cell's own sides, to its own particle.
  const double cell = std::pow(0.125, D - 1);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (int d = 0; d < D; ++d) {
      const double low = cloud.X[i][d]<0.125, high = cloud.X[i][d]> brick_size<D>()[d] - 0.125;
      CHECK(std::abs(own[i][d] - cell * (high - low)) < 1e-12);
    }
}

TEST_CASE_TEMPLATE("facets of nodes pass through them", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const Cloud<D> exact =
      make_cloud(box<D>(Vec<D>::Zero(), brick_size<D>()), {.dx = 0.125, .jitter = 0.25, .seed = 5});
  for (const bool measured : {false, true}) {
    Cloud<D> cloud = exact;
    if (measured) find_volumes(cloud);
    enclose_cloud(cloud);
    check_encloses(cloud);
    std::vector<Vec<D>> own(cloud.size(), Vec<D>::Zero());
    for (const Facet<D>& f : cloud.facets) {
      CHECK(off_the_brick(f) < 1e-12);
      own[static_cast<std::size_t>(f.owner)] += f.area;
    }
    for (std::size_t i = 0; i < cloud.size(); ++i) CHECK((own[i] - exact.B[i]).norm() < 1e-12);
  }
}

TEST_CASE_TEMPLATE("facets of jittered middles of cells lie near the faces", Dimension, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  Cloud<D> cloud = bare_brick<D>(Lattice::cell_centred);
  shake(cloud, 0.25);
  enclose_cloud(cloud);
  check_encloses(cloud);
  double off = 0, tilt = 0, total = 0;
  for (const Facet<D>& f : cloud.facets) {
    const double size = f.area.norm();
    off += size * std::pow(off_the_brick(f), 2);
    tilt += size - f.area.cwiseAbs().maxCoeff();
    total += size;
  }
  const double area = 2 * brick_size<D>().prod() * brick_size<D>().cwiseInverse().sum();
  CHECK(total == doctest::Approx(area).epsilon(0.02));
  CHECK(std::sqrt(off / total) < 0.15 * cloud.dx);
  CHECK(tilt < 0.005 * total);  // a degree is 0.00015, the hull of the points as it is has 0.03
}

TEST_CASE("facets of graded cells, long ones among them") {
  Cloud<2> cloud;
  double left = 0;
  for (int i = 0; i < 20; ++i) {
    const double w = 0.02 * std::pow(1.08, i);
    for (int j = 0; j < 8; ++j) {
      cloud.X.push_back({left + w / 2, 0.05 * (j + 0.5)});
      cloud.V.push_back(0.05 * w);
    }
    left += w;
  }
  enclose_cloud(cloud);
  check_encloses(cloud);
  for (const Facet<2>& f : cloud.facets) {
    const Vec<2> far = (f.centre - Vec<2>(left, 0.4)).cwiseAbs(), near = f.centre.cwiseAbs();
    CHECK(std::min({far.x(), far.y(), near.x(), near.y()}) < 1e-3 * 0.05);
  }
}

TEST_CASE("given volumes open re-entrant corners and gaps of one spacing") {
  const auto slit = box<2>({0, 0}, {1, 1}) - box<2>({0.4, 0.5}, {0.6, 2});
  for (const auto& body : {box<2>({0, 0}, {1, 1}) - box<2>({0.5, 0.5}, {2, 2}), slit}) {
    Cloud<2> cloud = make_cloud(body, {.dx = 0.1});
    const auto B = cloud.B;
    enclose_cloud(cloud);
    check_encloses(cloud);
    std::vector<Vec<2>> own(cloud.size(), Vec<2>::Zero());
    for (const Facet<2>& f : cloud.facets) own[static_cast<std::size_t>(f.owner)] += f.area;
    for (std::size_t i = 0; i < cloud.size(); ++i) CHECK((own[i] - B[i]).norm() < 1e-9);
  }
}

TEST_CASE("each part of a body has a surface of its own") {
  Cloud<2> cloud = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 0.1, .lattice = Lattice::cell_centred});
  const Cloud<2> nodes = make_cloud(box<2>({2, 0}, {3, 1}), {.dx = 0.1});
  cloud.X.insert(cloud.X.end(), nodes.X.begin(), nodes.X.end());
  cloud.V.insert(cloud.V.end(), nodes.V.begin(), nodes.V.end());
  enclose_cloud(cloud);
  check_encloses(cloud);
  double left = 0, right = 0;
  for (const Facet<2>& f : cloud.facets) (f.owner < 100 ? left : right) += f.centre.dot(f.area) / 2;
  CHECK(left == doctest::Approx(1).epsilon(1e-12));
  CHECK(right == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("volumes that belong to no such body are refused") {
  Cloud<2> cloud = bare_brick<2>(Lattice::node_centred);
  const auto V = cloud.V;
  for (double& v : cloud.V) v *= 0.8;
  CHECK_THROWS_WITH_AS(enclose_cloud(cloud), doctest::Contains("the volumes sum to 1.2, less than the 1.5"),
                       InputError);
  for (double& v : cloud.V) v *= 5;
  CHECK_THROWS_WITH_AS(enclose_cloud(cloud), doctest::Contains("too much for the body"), InputError);
  cloud.V = V;
  for (double& v : cloud.V) v *= 0.99;
  enclose_cloud(cloud);
  check_encloses(cloud);
}

TEST_CASE_TEMPLATE("areas without places are put where the volume wants them", Dimension, Dim<1>, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  Cloud<D> cells = bare_brick<D>(Lattice::cell_centred);
  enclose_cloud(cells);
  cells.B.assign(cells.size(), Vec<D>::Zero());
  for (const Facet<D>& f : cells.facets) cells.B[static_cast<std::size_t>(f.owner)] += f.area;
  place_areas(cells);
  check_encloses(cells);
  for (const Facet<D>& f : cells.facets) CHECK(off_the_brick(f) < 1e-12);
  CHECK(close_areas(cells) < 1e-12);

  Cloud<D> nodes = make_cloud(box<D>(Vec<D>::Zero(), brick_size<D>()), {.dx = 0.125, .jitter = 0.2});
  place_areas(nodes);
  check_encloses(nodes);
  for (const Facet<D>& f : nodes.facets) CHECK(f.centre == nodes.X[static_cast<std::size_t>(f.owner)]);

  shake(cells, 0.25);
  place_areas(cells);
  const double change = close_areas(cells);
  MESSAGE("change of the areas of jittered middles of cells: " << change);
  CHECK(change < 0.02);
  check_encloses(cells);
}

TEST_CASE_TEMPLATE("the spacing is a lattice's, and of jittered points that of their volumes", Dimension,
                   Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto spacing = [](const Cloud<D>& c) {
    return std::max(median_distance<D>(c.X), spacing_by_volume(c.V, D));
  };
  CHECK(spacing(bare_brick<D>(Lattice::node_centred)) == doctest::Approx(0.125).epsilon(1e-9));
  Cloud<D> cells = bare_brick<D>(Lattice::cell_centred);
  CHECK(spacing(cells) == doctest::Approx(0.125).epsilon(1e-9));
  shake(cells, 0.25);
  CHECK(spacing(cells) == doctest::Approx(0.125).epsilon(1e-9));
  Cloud<D> nodes = bare_brick<D>(Lattice::node_centred, 0.25);
  find_volumes(nodes);
  CHECK(spacing(nodes) == doctest::Approx(0.125).epsilon(0.1));
}
