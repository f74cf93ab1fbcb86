// Recovered stresses: exact where the formulation is, blind to other bodies and materials.
#include <doctest/doctest.h>

#include <taut/base/error.hpp>
#include <taut/output/stress_recovery.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

const MaterialParameters parameters{.E = 1e6, .nu = 0.3, .density = 1000};

template <int D>
Cloud<D> celled(double jitter) {
  return make_cloud(box<D>(Vec<D>::Zero(), Vec<D>::Ones()), {.dx = 1.0 / 6, .jitter = jitter, .cells = true});
}

/// u of degree 2, a matrix of small numbers for each component.
template <int D>
Vec<D> bend(const Vec<D>& X) {
  Vec<D> u;
  for (int i = 0; i < D; ++i) {
    u[i] = 0;
    for (int j = 0; j < D; ++j)
      for (int k = 0; k <= j; ++k) u[i] += 0.01 * (1 + i - 0.6 * j + 0.2 * k) * X[j] * X[k];
  }
  return u;
}

template <int D>
Mat<D> bend_gradient(const Vec<D>& X) {
  Mat<D> g = Mat<D>::Zero();
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j)
      for (int k = 0; k <= j; ++k) {
        const double c = 0.01 * (1 + i - 0.6 * j + 0.2 * k);
        g(i, j) += c * X[k];
        g(i, k) += c * X[j];
      }
  return g;
}

template <int D>
Mat<D> hooke(const Mat<D>& g) {
  return parameters.lambda() * g.trace() * Mat<D>::Identity() + parameters.mu() * (g + g.transpose());
}

template <int D>
Simulation<D> bent(const Cloud<D>& cloud, const Method& method) {
  Simulation<D> s(cloud, make_material<D>("linear_elastic", parameters), method);
  s.set_displacement(bend<D>);
  s.prepare();
  return s;
}

/// Largest errors of the stress as integrated and as recovered, over E.
template <int D>
std::pair<double, double> errors(const Simulation<D>& s) {
  const std::vector<Mat<D>> recovered = StressRecovery<D>(s).first_piola_kirchhoff();
  double own = 0, fitted = 0;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Mat<D> exact = hooke<D>(bend_gradient<D>(s.reference_position(i)));
    own = std::max(own, (s.first_piola_kirchhoff(i) - exact).norm() / parameters.E);
    fitted = std::max(fitted, (recovered[i] - exact).norm() / parameters.E);
  }
  return {own, fitted};
}

/// A bar along x of the given material, its right half another hundred times as soft or, with a `gap`,
/// another body, with strains of 1 % and `right`.
Simulation<2> halves(const Method& method, double gap, double right) {
  const Shape<2> first = box<2>({0, 0}, {1, 0.5}), second = box<2>({1 + gap, 0}, {2 + gap, 0.5});
  Simulation<2> s(make_cloud(first | second, {.dx = 0.1, .cells = true}),
                  make_material<2>("linear_elastic", parameters), method);
  MaterialParameters soft = parameters;
  soft.E /= 100;
  const double middle = 1 + gap / 2 + 1e-9;
  if (gap == 0)
    s.set_material([=](const Vec<2>& X) { return X[0] > middle; }, make_material<2>("linear_elastic", soft));
  s.set_displacement([=](const Vec<2>& X) { return Vec<2>((X[0] < middle ? 0.01 : right) * X[0], 0); });
  s.prepare();
  return s;
}

}  // namespace

TEST_CASE_TEMPLATE("recovered stress of stress points: exact for quadratic displacements up to the corners",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto [own, fitted] = errors(bent(celled<D>(0), {.formulation = "tl_stress_points"}));
  CHECK(fitted < 1e-12);
  CHECK(own > 1e-3);  // half a spacing off at the faces
}

TEST_CASE_TEMPLATE("recovered stress keeps what the operators have right, on jittered clouds as well",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const Method quadratic{
      .operators = "quadratic", .support_dx = 2.4, .pair_precision = PairPrecision::double_precision};
  CHECK(errors(bent(celled<D>(0.15), quadratic)).second < 1e-10);
}

TEST_CASE("recovered Cauchy stress of a stretched and turned body is that of the law") {
  Mat<3> F;
  F << 1.2, 0.1, 0, -0.1, 0.9, 0.2, 0, 0.1, 1.1;
  for (const char* formulation : {"tl_displacement", "tl_bond_associated", "tl_stress_points"}) {
    Simulation<3> s(celled<3>(0.15), make_material<3>("neo_hookean", parameters),
                    {.formulation = formulation, .operators = "corrected"});
    s.set_displacement([&](const Vec<3>& X) { return Vec<3>(F * X - X); });
    s.prepare();
    const auto sigma = StressRecovery<3>(s).cauchy_stress();
    for (std::size_t i = 0; i < s.size(); i += 7)
      CHECK((sigma[i] - s.cauchy_stress(i)).norm() < 1e-5 * parameters.E);  // vectors in single precision
  }
}

TEST_CASE("recovered stress does not cross to other bodies, nor to other materials") {
  const double modulus = parameters.lambda() + 2 * parameters.mu();
  const auto check = [&](const Simulation<2>& s, double middle, double left, double right) {
    const auto P = StressRecovery<2>(s).first_piola_kirchhoff();
    for (std::size_t i = 0; i < s.size(); ++i)
      CHECK(P[i](0, 0) == doctest::Approx(s.reference_position(i)[0] < middle ? left : right).epsilon(1e-5));
  };
  for (const char* formulation : {"tl_displacement", "tl_bond_associated", "tl_stress_points"}) {
    const Method method{.formulation = formulation, .operators = "corrected"};
    check(halves(method, 0.2, -0.02), 1.1, 0.01 * modulus, -0.02 * modulus);
    check(halves(method, 0, 0.01), 1 + 1e-9, 0.01 * modulus, 0.0001 * modulus);
  }
}

TEST_CASE("recovered stress of a material that is thinner than its cells is that of the cells around it") {
  Simulation<2> s(celled<2>(0), make_material<2>("linear_elastic", parameters),
                  {.formulation = "tl_stress_points"});
  MaterialParameters soft = parameters;
  soft.E /= 100;
  s.set_material([](const Vec<2>& X) { return std::abs(X[0] - 0.5) < 1e-9; },
                 make_material<2>("linear_elastic", soft));
  s.set_displacement([](const Vec<2>& X) { return Vec<2>(0.01 * X); });
  s.prepare();
  const auto P = StressRecovery<2>(s).first_piola_kirchhoff();
  const Mat<2> exact = hooke<2>(0.01 * Mat<2>::Identity());
  for (std::size_t i = 0; i < s.size(); ++i) CHECK((P[i] - exact).norm() < 1e-10 * exact.norm());
}

TEST_CASE("recovered stress: what it cannot be had of is said") {
  Simulation<2> early(celled<2>(0), make_material<2>("linear_elastic", parameters), {});
  CHECK_THROWS_WITH_AS(StressRecovery<2>{early}, doctest::Contains("prepare, run or relax"), InputError);
  early.prepare();
  CHECK_THROWS_WITH_AS(StressRecovery<2>(early, 1.5), doctest::Contains("between 2 and 20"), InputError);
  Simulation<2> rates(celled<2>(0), make_material<2>("hypoelastic", parameters),
                      {.formulation = "ul_basic", .operators = "standard", .support_dx = 2.4});
  rates.prepare();
  CHECK_THROWS_WITH_AS(StressRecovery<2>{rates}, doctest::Contains("ul_basic keeps no reference"),
                       InputError);
}
