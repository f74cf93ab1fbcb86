// Fits of scattered samples: what they reproduce, and what they say where they cannot be made.
#include <doctest/doctest.h>

#include <random>
#include <taut/base/error.hpp>
#include <taut/operators/patch_fit.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D>
PatchPoints<D> points_of_one_group(std::vector<Vec<D>> X) {
  const std::size_t n = X.size();
  return {std::move(X), std::vector<Index>(n, 0)};
}

/// A field whose components are polynomials of degree 1 or 2.
template <int D>
Mat<D> field(const Vec<D>& X, int degree) {
  Mat<D> value;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      double sum = 2 + i - 3 * j;
      for (int d = 0; d < D; ++d) {
        sum += (1 + d - 0.7 * i + 0.3 * j) * X[d];
        if (degree == 2)
          for (int e = 0; e < D; ++e) sum += (0.5 - d + 0.4 * e + i * j) * X[d] * X[e];
      }
      value(i, j) = sum;
    }
  return value;
}

/// Largest error of a fit from samples to targets, over the field's size of about 1.
template <int D>
double error(const PatchFit<D>& fit, const PatchPoints<D>& targets, const PatchPoints<D>& samples,
             int degree) {
  std::vector<Mat<D>> values;
  for (const Vec<D>& X : samples.X) values.push_back(field<D>(X, degree));
  const std::vector<Mat<D>> fitted = fit(values);
  double largest = 0;
  for (std::size_t t = 0; t < fitted.size(); ++t)
    largest = std::max(largest, (fitted[t] - field<D>(targets.X[t], degree)).norm());
  return largest;
}

/// Centres of the cells of a lattice.
template <int D>
PatchPoints<D> centres(const Cloud<D>& cloud) {
  std::vector<Vec<D>> X;
  for (const auto& cell : cloud.cells) {
    X.push_back(Vec<D>::Zero());
    for (const Index corner : cell) X.back() += cloud.X[static_cast<std::size_t>(corner)] / (1 << D);
  }
  return points_of_one_group<D>(std::move(X));
}

}  // namespace

TEST_CASE_TEMPLATE("patch fit: quadratic fields are exact inside, on faces, edges and corners", Dimension,
                   Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.3}) {
    const Cloud<D> cloud =
        make_cloud(box<D>(Vec<D>::Zero(), Vec<D>::Ones()), {.dx = 1.0 / 6, .jitter = jitter, .cells = true});
    const auto particles = points_of_one_group<D>(cloud.X);
    CHECK(error(PatchFit<D>(particles, particles, 3.2 / 6), particles, particles, 2) < 1e-10);
    const auto cells = centres(cloud);
    CHECK(error(PatchFit<D>(particles, cells, 3.2 / 6), particles, cells, 2) < 1e-9);
  }
}

TEST_CASE("patch fit: of a sheet too thin for a quadratic across it, linear fields are exact") {
  for (const double thickness : {1.0, 2.0}) {
    const Cloud<3> cloud =
        make_cloud(box<3>(Vec<3>::Zero(), {8, 7, thickness}), {.dx = 1, .jitter = 0.2, .cells = true});
    const auto particles = points_of_one_group<3>(cloud.X), cells = centres(cloud);
    const PatchFit<3> own(particles, particles, 3.2), from_cells(particles, cells, 3.2);
    CHECK(error(own, particles, particles, 1) < 1e-10);
    // One layer of cells says nothing of what changes across it, two layers nothing of curvature.
    std::vector<Mat<3>> flat, bent, sloped;
    for (const Vec<3>& X : cells.X) {
      flat.push_back(Mat<3>::Identity());
      bent.push_back(X[0] * X[1] * Mat<3>::Identity());
      sloped.push_back(X[2] * Mat<3>::Identity());
    }
    const auto constant = from_cells(flat), curved = from_cells(bent), linear = from_cells(sloped);
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      CHECK((constant[i] - Mat<3>::Identity()).norm() < 1e-10);
      CHECK(curved[i](0, 0) == doctest::Approx(cloud.X[i][0] * cloud.X[i][1]).epsilon(1e-9).scale(10));
      if (thickness > 1) CHECK(linear[i](0, 0) == doctest::Approx(cloud.X[i][2]).epsilon(1e-9).scale(10));
    }
  }
}

TEST_CASE("patch fit: rough samples come out smoother, groups apart stay apart") {
  const Cloud<2> cloud = make_cloud(box<2>(Vec<2>::Zero(), Vec<2>::Ones()), {.dx = 0.05, .jitter = 0.2});
  auto particles = points_of_one_group<2>(cloud.X);
  std::mt19937 generator(3);
  std::normal_distribution<double> noise;
  std::vector<Mat<2>> rough;
  for (std::size_t i = 0; i < cloud.size(); ++i) rough.push_back(noise(generator) * Mat<2>::Identity());
  const auto smooth = PatchFit<2>(particles, particles, 3.2 * cloud.dx)(rough);
  double before = 0, after = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    before += rough[i].squaredNorm(), after += smooth[i].squaredNorm();
  CHECK(after < 0.5 * before);

  std::vector<Mat<2>> step;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    particles.group[i] = cloud.X[i][0] < 0.5;
    step.push_back(particles.group[i] * Mat<2>::Identity());
  }
  const auto kept = PatchFit<2>(particles, particles, 3.2 * cloud.dx)(step);
  for (std::size_t i = 0; i < cloud.size(); ++i) CHECK((kept[i] - step[i]).norm() < 1e-12);
}

TEST_CASE("patch fit: what cannot be fitted is said") {
  const auto two = points_of_one_group<1>({Vec<1>(0.0), Vec<1>(1.0)});
  auto far = points_of_one_group<1>({Vec<1>(0.25), Vec<1>(7.0)});
  CHECK_THROWS_WITH_AS(PatchFit<1>(two, far, 0.5), doctest::Contains("within 0.5 m of target 1 at (1)"),
                       InputError);
  CHECK_THROWS_WITH_AS(PatchFit<1>(two, two, -1), doctest::Contains("radius -1"), InputError);
  CHECK_THROWS_WITH_AS(PatchFit<1>(two, two, 2)(std::vector<Mat<1>>(3)), doctest::Contains("3 values for 2"),
                       InputError);
  far.group.pop_back();
  CHECK_THROWS_WITH_AS(PatchFit<1>(two, far, 2), doctest::Contains("2 samples but 1 groups"), InputError);
}
