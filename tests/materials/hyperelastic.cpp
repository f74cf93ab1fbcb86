#include <doctest/doctest.h>

#include <taut/base/error.hpp>
#include <taut/base/small_solve.hpp>

#include "support.hpp"

using namespace taut;
using namespace taut::test;

namespace {

MaterialParameters parameters(double nu, Plane plane) { return {3.0, nu, 2.0, plane}; }

/// Small-strain Hooke in-plane constant.
double plane_lambda(const MaterialParameters& p, int dimension) {
  return dimension == 2 && p.plane == Plane::stress ? p.E * p.nu / (1 - p.nu * p.nu) : p.lambda();
}

template <int D>
Mat<D> polar_rotation_by_svd(const Mat<D>& F) {
  if constexpr (D == 1) {
    return Mat<1>::Identity();
  } else {
    const Spectrum<D> svd = right_singular<D>(F);
    return F * svd.vectors * svd.values.cwiseInverse().asDiagonal() * svd.vectors.transpose();
  }
}

}  // namespace

TEST_CASE("P is the derivative of the energy") {
  for (const std::string name : {"linear_elastic", "st_venant_kirchhoff", "neo_hookean"})
    for (const double nu : {-0.2, 0.0, 0.3, 0.49}) {
      Random random(7);
      for_each_mode([&](auto dimension, Plane plane) {
        constexpr int D = decltype(dimension)::value;
        CAPTURE(name);
        CAPTURE(nu);
        CAPTURE(D);
        CAPTURE(static_cast<int>(plane));
        const auto material = hyperelastic<D>(name, parameters(nu, plane));
        REQUIRE(material->has_energy());
        double worst = 0;
        for (int trial = 0; trial < 30; ++trial) {
          const Mat<D> F = random.deformation<D>(0.7, 1.6), A = random.matrix<D>(1);
          // Fourth-order central difference along A.
          const auto W = [&](double x) { return evaluate<D>(*material, F + x * A).energy; };
          const double h = 1e-3;
          const double slope = (8 * (W(h) - W(-h)) - (W(2 * h) - W(-2 * h))) / (12 * h);
          const Mat<D> P = stress<D>(*material, F);
          const double scale = material->parameters().lambda() + P.norm();
          worst = std::max(worst, std::abs(P.cwiseProduct(A).sum() - slope) / scale);
        }
        CHECK(worst < 1e-9);
      });
    }
}

TEST_CASE("the reference is free of stress and energy, and any rotation of it for the objective laws") {
  for (const std::string& name : hyperelastic_names()) {
    Random random(3);
    for_each_mode([&](auto dimension, Plane plane) {
      constexpr int D = decltype(dimension)::value;
      const auto material = hyperelastic<D>(name, parameters(0.3, plane));
      const auto [P, energy] = evaluate<D>(*material, Mat<D>::Identity());
      CHECK(P.norm() == 0);
      CHECK(energy == 0);
      if (name == "linear_elastic") return;
      for (int trial = 0; trial < 10; ++trial)
        CHECK(stress<D>(*material, random.rotation<D>()).norm() < 1e-14);
    });
  }
}

TEST_CASE("linear_elastic makes stress out of a rotation, as documented") {
  Mat<2> R;
  R << 0, -1, 1, 0;
  CHECK(stress<2>(*hyperelastic<2>("linear_elastic", parameters(0.3, Plane::strain)), R).norm() > 1);
}

TEST_CASE("objectivity: P(Q F) = Q P(F)") {
  for (const std::string name : {"st_venant_kirchhoff", "corotated_svk", "neo_hookean"}) {
    Random random(11);
    for_each_mode([&](auto dimension, Plane plane) {
      constexpr int D = decltype(dimension)::value;
      const auto material = hyperelastic<D>(name, parameters(0.4, plane));
      for (int trial = 0; trial < 20; ++trial) {
        const Mat<D> F = random.deformation<D>(0.5, 2), Q = random.rotation<D>();
        const Mat<D> P = stress<D>(*material, F);
        CHECK((stress<D>(*material, Q * F) - Q * P).norm() <= 1e-13 * (1 + P.norm()));
      }
    });
  }
}

TEST_CASE("P F^T is symmetric, but for the corotated law") {
  Random random(13);
  for_each_mode([&](auto dimension, Plane plane) {
    constexpr int D = decltype(dimension)::value;
    for (int trial = 0; trial < 20; ++trial) {
      const Mat<D> F = random.deformation<D>(0.5, 2);
      for (const std::string name : {"st_venant_kirchhoff", "neo_hookean"}) {
        const Mat<D> tau = stress<D>(*hyperelastic<D>(name, parameters(0.3, plane)), F) * F.transpose();
        CHECK((tau - tau.transpose()).norm() <= 1e-14 * (1 + tau.norm()));
      }
    }
  });
}

TEST_CASE("all laws agree with Hooke's at small strain") {
  for (const std::string& name : hyperelastic_names())
    for (const double nu : {-0.3, 0.0, 0.3, 0.49}) {
      Random random(17);
      for_each_mode([&](auto dimension, Plane plane) {
        constexpr int D = decltype(dimension)::value;
        const MaterialParameters p = parameters(nu, plane);
        const auto material = hyperelastic<D>(name, p);
        for (const double size : {1e-4, 1e-7}) {
          const Mat<D> A = random.matrix<D>(1), e = size * (A + A.transpose()) / 2;
          const Mat<D> sigma = plane_lambda(p, D) * e.trace() * Mat<D>::Identity() + 2 * p.mu() * e;
          const auto [P, energy] = evaluate<D>(*material, Mat<D>::Identity() + e);
          // First order: the difference is quadratic in the strain; F itself is rounded to 1e-16.
          const double stiffness = plane_lambda(p, D) + 2 * p.mu();
          CHECK((P - sigma).norm() <= stiffness * (40 * size * size + 4e-16));
          if (material->has_energy())
            CHECK(std::abs(energy - sigma.cwiseProduct(e).sum() / 2) <=
                  stiffness * (60 * size * size * size + 4e-16 * size));
        }
      });
    }
}

TEST_CASE("plane stress is the 3D law with no stress on the faces") {
  for (const std::string name : {"linear_elastic", "st_venant_kirchhoff", "neo_hookean"})
    for (const double nu : {-0.2, 0.0, 0.3, 0.499}) {
      Random random(19);
      const MaterialParameters p = parameters(nu, Plane::stress);
      const auto sheet = hyperelastic<2>(name, p);
      const auto solid = hyperelastic<3>(name, p);
      for (int trial = 0; trial < 20; ++trial) {
        const Mat<2> F = random.deformation<2>(0.85, 1.15);
        // Bisection for F_33 where P_33 = 0 in 3D.
        Mat<3> G = Mat<3>::Identity();
        G.topLeftCorner<2, 2>() = F;
        double low = 0.5, high = 2;
        if (name == "linear_elastic") low = -9, high = 9;
        for (int i = 0; i < 60; ++i) {
          G(2, 2) = (low + high) / 2;
          (stress<3>(*solid, G)(2, 2) > 0 ? high : low) = G(2, 2);
        }
        const auto [P3, W3] = evaluate<3>(*solid, G);
        REQUIRE(std::abs(P3(2, 2)) < 1e-12 * solid->parameters().lambda() + 1e-12);
        const auto [P2, W2] = evaluate<2>(*sheet, F);
        CHECK((P2 - P3.topLeftCorner<2, 2>()).norm() <= 2e-12 * (1 + p.lambda()));
        CHECK(std::abs(W2 - W3) <= 2e-12 * (1 + p.lambda()));
      }
    }
}

TEST_CASE("neo_hookean sheet: the thickness solves P_33 = 0 to round-off at large strain") {
  // P = mu (F - w F^-T) gives w = F_33² back from the in-plane stress; it must satisfy its equation.
  for (const double nu : {0.0, 0.1, 0.3, 0.45, 0.499, 0.4999999}) {
    const MaterialParameters p = parameters(nu, Plane::stress);
    const auto sheet = hyperelastic<2>("neo_hookean", p);
    const long double a = p.lambda() / (2 * p.mu());
    double worst = 0;
    for (double J = 0.05; J < 20; J *= 1.05) {
      Mat<2> F = Mat<2>::Identity();
      F(0, 0) = J;
      // P_22 = mu (1 - w)
      const long double z = -stress<2>(*sheet, F)(1, 1) / p.mu(), w = 1 + z;
      const long double residual = z + a * std::log(w) + 2 * a * std::log(static_cast<long double>(J));
      // As an error of w, relative; that of z where w is small.
      worst = std::max(worst, static_cast<double>(std::abs(residual / (a + w)) * std::min(w, 1.0L)));
    }
    CAPTURE(nu);
    CHECK(worst < 1e-14);
  }
}

TEST_CASE("corotated_svk is the rotation of F times the SVK stress") {
  for (const double range : {1.3, 10.0, 100.0}) {
    Random random(23);
    for_each_mode([&](auto dimension, Plane plane) {
      constexpr int D = decltype(dimension)::value;
      const MaterialParameters p = parameters(0.3, plane);
      const auto corotated = hyperelastic<D>("corotated_svk", p);
      for (int trial = 0; trial < 200; ++trial) {
        const Vec<D> logarithms = random.stretches<D>(-std::log(range), std::log(range));
        const Mat<D> F = random.deformation<D>(logarithms.array().exp().matrix());
        const Mat<D> R = polar_rotation_by_svd<D>(F);
        const Mat<D> E = (F.transpose() * F - Mat<D>::Identity()) / 2;
        const Mat<D> S = plane_lambda(p, D) * E.trace() * Mat<D>::Identity() + 2 * p.mu() * E;
        CHECK((stress<D>(*corotated, F) - R * S).norm() <= 2e-14 * (1 + range) * (1 + S.norm()));
      }
    });
  }
}

TEST_CASE("corotated_svk says that it has no energy") {
  const auto material = hyperelastic<2>("corotated_svk", parameters(0.3, Plane::strain));
  CHECK_FALSE(material->has_energy());
  Field F(lanes, 4), energy(lanes, 1);
  CHECK_THROWS_AS(material->stress({lanes, F.stride(), F.data(), F.data(), energy.data()}), InputError);
}

TEST_CASE("an inverted particle shows as NaN where the law has no sense there, and nowhere else") {
  for_each_mode([&](auto dimension, Plane plane) {
    constexpr int D = decltype(dimension)::value;
    for (const std::string name : {"corotated_svk", "neo_hookean"})
      for (const double broken : {-0.3, 0.0, std::nan("")}) {
        Field F(16, D * D), P(16, D * D);
        for (int p = 0; p < 16; ++p) F.set_mat<D>(p, Mat<D>::Identity() * (1 + 0.01 * p));
        Mat<D> bad = Mat<D>::Identity();
        bad(0, 0) = broken;
        F.set_mat<D>(11, bad);
        hyperelastic<D>(name, parameters(0.3, plane))->stress({16, F.stride(), F.data(), P.data(), nullptr});
        for (int p = 0; p < 16; ++p) CHECK(std::isnan(P.component(0)[p]) == (p == 11));
      }
  });
}

TEST_CASE("a sheet of negative Poisson's ratio has no state under strong compression") {
  const auto sheet = hyperelastic<2>("neo_hookean", parameters(-0.3, Plane::stress));
  CHECK(stress<2>(*sheet, Mat<2>::Identity() * 0.8).allFinite());
  CHECK(stress<2>(*sheet, Mat<2>::Identity() * 3).allFinite());
  CHECK(std::isnan(stress<2>(*sheet, Mat<2>::Identity() * 0.3)(0, 0)));
}

TEST_CASE("blocks: in place, any number of packs, padding untouched, the same bits on every lane") {
  for (const std::string& name : hyperelastic_names())
    for_each_mode([&](auto dimension, Plane plane) {
      constexpr int D = decltype(dimension)::value;
      const auto material = hyperelastic<D>(name, parameters(0.3, plane));
      constexpr std::size_t stride = 40;
      Field F(stride, D * D);
      Random random(29);
      std::vector<Mat<D>> expected;
      for (std::size_t p = 0; p < stride; ++p) {
        F.set_mat<D>(p, random.deformation<D>(0.8, 1.3));
        expected.push_back(stress<D>(*material, F.mat<D>(p)));
      }
      for (const int n : {8, 16, 24, 40}) {
        Field P(stride, D * D), energy(stride, 1), in_place = F;
        for (double& v : P.flat()) v = -77;
        for (double& v : energy.flat()) v = -77;
        const bool has_energy = material->has_energy();
        material->stress({n, stride, F.data(), P.data(), has_energy ? energy.data() : nullptr});
        material->stress({n, stride, in_place.data(), in_place.data(), nullptr});
        for (int p = 0; p < static_cast<int>(stride); ++p) {
          CHECK(P.mat<D>(p) == (p < n ? expected[p] : Mat<D>::Constant(-77)));
          CHECK(in_place.mat<D>(p) == (p < n ? expected[p] : F.mat<D>(p)));
          if (has_energy) CHECK((energy.data()[p] == -77) == (p >= n));
        }
      }
    });
}
