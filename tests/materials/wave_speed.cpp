#include <doctest/doctest.h>

#include <algorithm>

#include "support.hpp"

using namespace taut;
using namespace taut::test;

namespace {

/// Speed of the fastest plane wave along N, by finite differences: root of the spectral radius of N·dP/dF·N /
/// rho0.
template <int D>
double speed_along(const Hyperelastic<D>& material, const Mat<D>& F, const Vec<D>& N) {
  Mat<D> A;
  const double h = 1e-5;
  for (int k = 0; k < D; ++k) {
    const Mat<D> dF = Vec<D>::Unit(k) * N.transpose();
    A.col(k) = (stress<D>(material, F + h * dF) - stress<D>(material, F - h * dF)) * N / (2 * h);
  }
  return std::sqrt(spectral_radius<D>(A) / material.density());
}

template <int D>
double fastest_wave(const Hyperelastic<D>& material, const Mat<D>& F, Random& random, int directions) {
  double fastest = 0;
  for (int i = 0; i < directions; ++i)
    fastest = std::max(fastest, speed_along<D>(material, F, random.direction<D>()));
  for (int i = 0; i < D; ++i) fastest = std::max(fastest, speed_along<D>(material, F, Vec<D>::Unit(i)));
  return fastest;
}

const std::vector<double> poisson_ratios = {-0.3, 0.0, 0.3, 0.49};

}  // namespace

TEST_CASE("the bound of the wave speed is that of the undeformed body at stretch 1") {
  for (const std::string& name : material_names())
    for (const double nu : poisson_ratios)
      for_each_mode([&](auto dimension, Plane plane) {
        constexpr int D = decltype(dimension)::value;
        const auto material = make_material<D>(name, {2.0, nu, 3.0, plane});
        CHECK(material->wave_speed(1, 1) == doctest::Approx(material->wave_speed()).epsilon(1e-14));
        CHECK(material->wave_speed(0.9, 1.1) >= material->wave_speed());
      });
}

TEST_CASE("no plane wave of a random state is faster than the bound for its stretches") {
  for (const std::string& name : hyperelastic_names())
    for (const double nu : poisson_ratios) {
      Random random(31);
      for_each_mode([&](auto dimension, Plane plane) {
        constexpr int D = decltype(dimension)::value;
        CAPTURE(name);
        CAPTURE(nu);
        CAPTURE(D);
        CAPTURE(static_cast<int>(plane));
        const auto material = hyperelastic<D>(name, {2.0, nu, 3.0, plane});
        for (const auto& [low, high] : {std::pair{0.9, 1.1}, {0.5, 1.0}, {1.0, 2.5}, {0.4, 2.5}})
          for (int trial = 0; trial < 12; ++trial) {
            const Vec<D> s = random.stretches<D>(low, high);
            const Mat<D> F = random.deformation<D>(s);
            if (!stress<D>(*material, F).allFinite()) continue;  // an auxetic sheet without a state
            const double fastest = fastest_wave<D>(*material, F, random, 12);
            const double J = F.determinant();
            // Tight ranges are the hardest: those of the state itself.
            CHECK(fastest <= 1.0001 * material->wave_speed(s.minCoeff(), s.maxCoeff(), J, J));
            CHECK(fastest <= 1.0001 * material->wave_speed(s.minCoeff(), s.maxCoeff()));
            CHECK(fastest <= 1.0001 * material->wave_speed(low, high));
          }
      });
    }
}

TEST_CASE("knowing J never loosens the bound") {
  for (const std::string& name : material_names())
    for_each_mode([&](auto dimension, Plane plane) {
      constexpr int D = decltype(dimension)::value;
      const auto material = make_material<D>(name, {2.0, 0.4, 3.0, plane});
      CHECK(material->wave_speed(0.8, 1.3, 0.95, 1.05) <= material->wave_speed(0.8, 1.3));
      CHECK(material->wave_speed(0.8, 1.3, 0.1, 9) == material->wave_speed(0.8, 1.3));
    });
}

TEST_CASE("the bound is at most 1.3 times the fastest wave of nearly uniaxial states") {
  for (const std::string& name : hyperelastic_names())
    for (const double nu : {0.0, 0.3, 0.45}) {
      Random random(37);
      for_each_mode([&](auto dimension, Plane plane) {
        constexpr int D = decltype(dimension)::value;
        const auto material = hyperelastic<D>(name, {2.0, nu, 3.0, plane});
        for (const double stretch : {0.8, 0.9, 1.1, 1.3, 1.5}) {
          Mat<D> F = Mat<D>::Identity();
          F(0, 0) = stretch;
          for (int i = 1; i < D; ++i)
            F(i, i) = std::pow(stretch, D == 2 && plane == Plane::strain ? -nu / (1 - nu) : -nu);
          const double fastest = fastest_wave<D>(*material, F, random, 30);
          const auto [low, high] = std::minmax(stretch, D == 1 ? stretch : F(D - 1, D - 1));
          const double bound = material->wave_speed(low, high, F.determinant(), F.determinant());
          CAPTURE(name);
          CAPTURE(nu);
          CAPTURE(D);
          CAPTURE(static_cast<int>(plane));
          CAPTURE(stretch);
          CHECK(bound <= 1.3 * fastest);
        }
      });
    }
}
