#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <taut/taut.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

/// Centroids of the cells of a box, each moved by up to `jitter` spacings along each axis; the box's own
/// facets.
template <int D>
Cloud<D> centroids(const Vec<D>& size, double dx, double jitter, unsigned seed = 1) {
  Cloud<D> cloud = make_cloud(box<D>(Vec<D>::Zero(), size), {.dx = dx, .lattice = Lattice::cell_centred});
  std::mt19937 random(seed);
  for (Vec<D>& X : cloud.X)
    for (int d = 0; d < D; ++d) X[d] += jitter * dx * (static_cast<double>(random()) / 2147483648.0 - 1);
  return cloud;
}

Method closed(int iterations, const char* kernel = "quadratic") {
  Method method = with_defaults({});
  method.operators = "compatible";
  method.kernel = kernel;
  method.pair_precision = PairPrecision::double_precision;
  method.compatible_iterations = iterations;
  return method;
}

/// Largest error of the displacement of a bar in uniform tension, over the largest displacement.
template <int D>
double tension_error(const Cloud<D>& cloud, const Vec<D>& size, const Method& method) {
  const double E = 1e6, nu = 0.3, stress = 1000;
  Simulation<D> bar(
      cloud, make_material<D>("linear_elastic", {.E = E, .nu = nu, .density = 1000, .plane = Plane::stress}),
      method);
  constexpr const char* faces[] = {"x_min", "y_min", "z_min"};
  double area = 1;
  for (int d = 0; d < D; ++d) {
    bar.roller(bar.face(faces[d]), d);
    if (d > 0) area *= size[d];
  }
  Vec<D> force = Vec<D>::Zero();
  force[0] = stress * area;
  bar.load(bar.face("x_max"), force);
  const RunResult result = bar.relax({.tolerance = 1e-12, .max_steps = 200000});
  CHECK(result.status == Status::ok);
  double worst = 0;
  for (std::size_t i = 0; i < bar.size(); ++i) {
    Vec<D> exact = -nu * stress / E * bar.reference_position(i);
    exact[0] = stress / E * bar.reference_position(i)[0];
    worst = std::max(worst, (bar.displacement(i) - exact).norm());
  }
  MESSAGE("tension error ", worst / (stress / E * size[0]), " steps ", result.steps);
  return worst / (stress / E * size[0]);
}

/// Relative error of the tip of a cantilever against Timoshenko's beam.
double tip_error_of(const Cloud<2>& cloud, double L, double H, const Method& method) {
  const double E = 1e6, load = 1;
  Simulation<2> beam(
      cloud, make_material<2>("linear_elastic", {.E = E, .nu = 0, .density = 1000, .plane = Plane::stress}),
      method);
  beam.clamp(beam.face("x_min"));
  beam.load(beam.face("x_max"), {0, -load});
  const RunResult result = beam.relax({.tolerance = 1e-5, .max_steps = 100000});
  CHECK(result.status == Status::ok);
  const double I = H * H * H / 12, exact = load * L * L * L / (3 * E * I) + 1.2 * load * L / (E / 2 * H);
  const double error = -beam.displacement_at({L, H / 2}).y() / exact - 1;
  MESSAGE("tip error ", error, " steps ", result.steps);
  return error;
}

}  // namespace

TEST_CASE("facets of cell-centred lattices enclose their volume") {
  const Shape<2> body = box<2>({0, 0}, {1, 0.5}) - sphere<2>({0.5, 0.25}, 0.15);
  for (const int samples : {1, 4}) {
    const Cloud<2> cloud =
        make_cloud(body, {.dx = 0.05, .lattice = Lattice::cell_centred, .samples = samples});
    Vec<2> sum = Vec<2>::Zero();
    Mat<2> first = Mat<2>::Zero();
    double volume = 0;
    for (const double V : cloud.V) volume += V;
    for (const auto& f : cloud.facets) {
      sum += f.area;
      first += f.centre * f.area.transpose();
    }
    CHECK(sum.norm() < 1e-13);
    CHECK((first - volume * Mat<2>::Identity()).norm() < 1e-13);
  }
}

TEST_CASE("a constant stress is exact on centroids with facets") {
  for (const double jitter : {0.0, 0.15, 0.25}) {
    CAPTURE(jitter);
    CHECK(tension_error<2>(centroids<2>({1, 0.4}, 0.1, jitter), {1, 0.4}, closed(3000)) < 1e-9);
    CHECK(tension_error<2>(centroids<2>({1, 0.4}, 0.1, jitter), {1, 0.4}, closed(20)) < 0.02);
  }
  CHECK(tension_error<3>(centroids<3>({0.6, 0.3, 0.3}, 0.1, 0.2), {0.6, 0.3, 0.3}, closed(3000)) < 1e-9);
}

TEST_CASE("cantilevers of centroids converge with second order") {
  for (const char* kernel : {"quadratic", "lucy"})
    for (const double jitter : {0.0, 0.25}) {
      CAPTURE(kernel);
      CAPTURE(jitter);
      double error[2] = {0, 0};
      for (const int fine : {0, 1})
        for (const unsigned seed : {1u, 2u, 3u})
          error[fine] += tip_error_of(centroids<2>({0.5, 0.1}, 0.1 / (8 << fine), jitter, seed), 0.5, 0.1,
                                      closed(20, kernel)) /
                         3;
      CHECK(std::abs(error[0]) < 0.08);
      CHECK(std::abs(error[1]) < 0.02);
      CHECK(std::log2(error[0] / error[1]) > 1.8);
    }
}

TEST_CASE(
    "walls between particles hold the displacement that is extrapolated to them, and follow a history") {
  Simulation<2> bar(centroids<2>({0.4, 0.2}, 0.05, 0.2),
                    make_material<2>("linear_elastic", {.E = 1e6, .nu = 0.3, .density = 1000}), closed(3000));
  bar.clamp(bar.face("x_min"));
  for (const int axis : {0, 1})
    bar.prescribe(bar.face("x_max"), axis, [axis](const Vec<2>&, double) { return axis == 0 ? 2e-3 : 0.0; });
  bar.roller(bar.face("y_min"), 1);
  bar.roller(bar.face("y_max"), 1);
  CHECK(bar.relax({.tolerance = 1e-11}).status == Status::ok);
  for (std::size_t i = 0; i < bar.size(); ++i) {
    CHECK(bar.displacement(i).x() == doctest::Approx(5e-3 * bar.reference_position(i).x()).epsilon(1e-8));
    CHECK(std::abs(bar.displacement(i).y()) < 1e-11);
  }
}

TEST_CASE("a mirrored half of a body of centroids moves as the whole") {
  const auto material = make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000});
  const auto tip = [&](bool half) {
    Simulation<2> bar(centroids<2>({0.8, half ? 0.2 : 0.4}, 0.05, 0), material, closed(3000));
    bar.clamp(bar.face("x_min"));
    bar.load(bar.face("x_max"), {half ? 5e4 : 1e5, 0});
    if (half) bar.symmetry_plane(1, 0.2);
    CHECK(bar.relax({.tolerance = 1e-9}).status == Status::ok);
    return bar.displacement_at({0.775, 0.175});
  };
  CHECK((tip(true) - tip(false)).norm() < 1e-8 * tip(false).norm());
}

TEST_CASE("points held twice are refused") {
  Simulation<2> sheet(centroids<2>({0.4, 0.2}, 0.05, 0),
                      make_material<2>("linear_elastic", {.E = 1e6, .nu = 0, .density = 1000}), closed(20));
  sheet.clamp(sheet.face("x_min"));
  sheet.clamp(sheet.face("x_min"));  // the same again replaces the first
  CHECK_NOTHROW(sheet.prepare());
  Cloud<2> thin = centroids<2>({0.4, 0.1}, 0.05, 0);
  for (std::size_t f = 0, n = thin.facets.size(); f < n; ++f) {
    thin.facets[f].area *= 0.5;
    thin.facets.push_back(thin.facets[f]);
  }
  Simulation<2> twice(thin, make_material<2>("linear_elastic", {.E = 1e6, .nu = 0, .density = 1000}),
                      closed(20));
  twice.clamp(twice.face("x_min"));
  CHECK_THROWS_WITH_AS(twice.prepare(), doctest::Contains("do not move independently"), InputError);
}
