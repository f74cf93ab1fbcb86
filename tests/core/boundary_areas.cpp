#include <doctest/doctest.h>

#include <cmath>
#include <taut/geometry/geometry.hpp>
#include <taut/simulation/simulation.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

/// Points of a disc on concentric rings, the outermost on its rim; no lattice.
Cloud<2> rings_of_disc(double radius, int rings) {
  Cloud<2> cloud;
  cloud.dx = radius / rings;
  const auto put = [&](double r, int n, double volume) {
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::acos(-1.0) * (i + 0.3 * r / radius) / n;
      cloud.X.push_back({r * std::cos(angle), r * std::sin(angle)});
      cloud.V.push_back(volume / n);
    }
  };
  const double pi = std::acos(-1.0);
  put(0, 1, pi * 0.25 * cloud.dx * cloud.dx);
  for (int k = 1; k <= rings; ++k) {
    const double inner = (k - 0.5) * cloud.dx, outer = std::min((k + 0.5) * cloud.dx, radius);
    put(k * cloud.dx, 6 * k, pi * (outer * outer - inner * inner));
  }
  return cloud;
}

template <int D>
void check_closed(const Cloud<D>& cloud) {
  Vec<D> sum = Vec<D>::Zero();
  Mat<D> first = Mat<D>::Zero();
  double volume = 0, total = 0;
  for (std::size_t a = 0; a < cloud.size(); ++a) {
    sum += cloud.B[a];
    first += cloud.X[a] * cloud.B[a].transpose();
    volume += cloud.V[a];
    total += cloud.B[a].norm();
  }
  CHECK(sum.norm() < 1e-12 * total);
  CHECK((first - volume * Mat<D>::Identity()).norm() < 1e-12 * volume);
}

}  // namespace

TEST_CASE("facets of a disc's rim are found: radial, equal, and enclosing its volume") {
  Cloud<2> disc = rings_of_disc(0.1, 12);
  enclose_cloud(disc);
  std::vector<Vec<2>> own(disc.size(), Vec<2>::Zero());
  for (const Facet<2>& f : disc.facets) own[static_cast<std::size_t>(f.owner)] += f.area;
  const double share = 2 * std::acos(-1.0) * 0.1 / 72;
  for (std::size_t a = 0; a < disc.size(); ++a) {
    CAPTURE(a);
    if (a + 72 < disc.size()) {
      CHECK(own[a].isZero(0));
    } else {
      CHECK(own[a].norm() == doctest::Approx(share).epsilon(0.02));
      CHECK(own[a].normalized().dot(disc.X[a].normalized()) > 0.999);
    }
  }
  CHECK(close_areas(disc) < 1e-12);
}

TEST_CASE("closing leaves areas alone that enclose the volume, and mends others") {
  Cloud<2> cloud = make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1, .jitter = 0.2});
  const auto B = cloud.B;
  CHECK(close_areas(cloud) < 1e-13);
  for (std::size_t a = 0; a < cloud.size(); ++a) cloud.B[a] = 1.03 * B[a] + Vec<2>(0.01, 0) * B[a].norm();
  const double change = close_areas(cloud);
  CHECK(change > 0.02);
  CHECK(change < 0.05);
  check_closed(cloud);
}

TEST_CASE("facets are closed like areas, and in their place") {
  Cloud<2> cloud = make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 0.1, .lattice = Lattice::cell_centred});
  enclose_cloud(cloud);
  const auto exact = cloud.facets;
  for (Facet<2>& f : cloud.facets) f.area *= 1.03;
  const double change = close_areas(cloud);
  CHECK(change > 0.02);
  CHECK(change < 0.05);
  CHECK(close_areas(cloud) < 1e-12);
  for (std::size_t k = 0; k < exact.size(); ++k) {
    CHECK(cloud.facets[k].centre == exact[k].centre);
    CHECK((cloud.facets[k].area - exact[k].area).norm() < 0.05 * exact[k].area.norm());
  }
}

TEST_CASE("a cantilever given as points and volumes bends right with compatible operators") {
  Cloud<2> cloud = jittered_cantilever();
  cloud.B.clear();
  const double error = tip_error(std::move(cloud), "compatible");
  MESSAGE("tip error " << error);
  CHECK(std::abs(error) < 0.04);
}
