// The whole, three-dimensional Cauchy stress of every formulation, and what is made of it.
#include <doctest/doctest.h>

#include <filesystem>
#include <taut/base/error.hpp>
#include <taut/taut.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

const MaterialParameters rubber{.E = 1e6, .nu = 0.3, .density = 1000};

template <int D>
Cloud<D> block() {
  return make_cloud(box<D>(Vec<D>::Zero(), Vec<D>::Constant(0.5)), {.dx = 0.125, .cells = true});
}

template <int D>
Mat<D> stretched() {
  Mat<D> F;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) F(i, j) = i == j ? 1.2 - 0.15 * i : 0.1 * (i - 2 * j);
  return F;
}

template <int D>
Simulation<D> deformed(const char* formulation, const std::shared_ptr<const Material<D>>& material,
                       const Mat<D>& F) {
  Simulation<D> s(block<D>(), material,
                  {.formulation = formulation,
                   .operators = "corrected",
                   .pair_precision = PairPrecision::double_precision});
  s.set_displacement([=](const Vec<D>& X) { return Vec<D>(F * X - X); });
  s.prepare();
  return s;
}

template <int D>
void check_law(const char* formulation, const char* name, Plane plane) {
  CAPTURE(formulation);
  CAPTURE(name);
  CAPTURE(D);
  MaterialParameters parameters = rubber;
  parameters.plane = plane;
  const auto material = make_material<D>(name, parameters);
  const Mat<D> F = stretched<D>();
  const Simulation<D> s = deformed<D>(formulation, material, F);
  const Mat<3> exact = dynamic_cast<const Hyperelastic<D>&>(*material).cauchy_stress(F);
  const double close = 1e-11 * exact.norm();
  const std::vector<Mat<3>> recovered = StressRecovery<D>(s).full_cauchy_stress();
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Mat<3> sigma = s.full_cauchy_stress(i);
    CHECK((sigma - exact).norm() < close);
    CHECK((sigma.topLeftCorner<D, D>() - s.cauchy_stress(i)).norm() == 0);
    CHECK((recovered[i] - exact).norm() < 100 * close);
  }
}

/// P = E (F - I): a user's law, which does not think of the third direction.
class Springs final : public Hyperelastic<2> {
 public:
  explicit Springs(const MaterialParameters& parameters) : Hyperelastic<2>(parameters) {}
  std::string_view name() const override { return "springs"; }
  void stress(const StressBlock<2>& block) const override {
    for (int c = 0; c < 4; ++c)
      for (int p = 0; p < block.n; ++p) {
        const std::size_t at = static_cast<std::size_t>(c) * block.stride + static_cast<std::size_t>(p);
        block.P[at] = parameters_.E * (block.F[at] - (c == 0 || c == 3));
      }
  }
  double wave_speed(double, double, double, double) const override { return Material<2>::wave_speed(); }
};

/// A bar or square of the hypoelastic material, pressed along x between walls on all other sides.
template <int D>
Mat<3> pressed(const char* formulation, double stretch, Plane plane) {
  MaterialParameters parameters = rubber;
  parameters.plane = plane;
  const double duration = 0.02;
  Simulation<D> s(block<D>(), make_material<D>("hypoelastic", parameters),
                  {.formulation = formulation, .support_dx = 2.4, .velocity_gradient = "corrected"});
  const auto everywhere = [](const Vec<D>&) { return true; };
  s.prescribe(everywhere, 0, [=](const Vec<D>& X, double t) { return (stretch - 1) * X[0] * t / duration; });
  for (int d = 1; d < D; ++d) s.roller(everywhere, d);
  REQUIRE(s.run(duration, {.max_step = 1e-4}).status == Status::ok);
  CHECK((s.full_cauchy_stress(3).template topLeftCorner<D, D>() - s.cauchy_stress(3)).norm() == 0);
  return s.full_cauchy_stress(3);
}

}  // namespace

TEST_CASE("total Lagrangian forms give the law's whole Cauchy stress in every dimension") {
  for (const char* formulation : {"tl_displacement", "tl_bond_associated", "tl_stress_points"})
    for (const char* name : {"linear_elastic", "st_venant_kirchhoff", "corotated_svk", "neo_hookean"}) {
      check_law<1>(formulation, name, Plane::strain);
      check_law<2>(formulation, name, Plane::strain);
      check_law<2>(formulation, name, Plane::stress);
      check_law<3>(formulation, name, Plane::strain);
    }
}

TEST_CASE("updated Lagrangian forms: confined compression in closed form, in the third direction too") {
  const double mu = rubber.mu(), K = rubber.bulk(), stretch = 0.95, theta = std::log(stretch);
  const double p = K * (1 / stretch - 1), axial = 4 * mu / 3 * theta - p, lateral = -2 * mu / 3 * theta - p;
  for (const char* formulation : {"ul_basic", "ul_artificial_stress"}) {
    CAPTURE(formulation);
    const auto check = [&](const Mat<3>& sigma) {
      CHECK(sigma(0, 0) == doctest::Approx(axial).epsilon(2e-3));
      CHECK(sigma(1, 1) == doctest::Approx(lateral).epsilon(2e-3));
      CHECK(sigma(2, 2) == doctest::Approx(lateral).epsilon(2e-3));
    };
    check(pressed<1>(formulation, stretch, Plane::strain));
    check(pressed<2>(formulation, stretch, Plane::strain));
    check(pressed<3>(formulation, stretch, Plane::strain));
    const Mat<3> membrane = pressed<2>(formulation, stretch, Plane::stress);
    CHECK(membrane(2, 2) == 0);
    CHECK(membrane(0, 0) < -0.05 * rubber.E);
  }
}

// SU2#2603, KratosMultiphysics#7715: a nearly incompressible square between walls. Taken as zero, sigma_zz
// makes the von Mises stress 25 times too large.
TEST_CASE("von Mises stress of a confined square is 2 mu e") {
  const MaterialParameters soft{.E = 1e6, .nu = 0.49, .density = 1000};
  const Mat<2> F{{1 - 1e-3, 0.0}, {0.0, 1.0}};
  for (const char* formulation : {"tl_displacement", "tl_bond_associated", "tl_stress_points"}) {
    CAPTURE(formulation);
    const Simulation<2> s = deformed<2>(formulation, make_material<2>("linear_elastic", soft), F);
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Mat<3> sigma = s.full_cauchy_stress(i);
      CHECK(von_mises(sigma) == doctest::Approx(671.141).epsilon(1e-6));
      CHECK(sigma(2, 2) == doctest::Approx(-16442.95).epsilon(1e-6));
      CHECK(sigma(0, 0) == doctest::Approx(-17114.09).epsilon(1e-6));
      CHECK(pressure(sigma) == doctest::Approx((17114.09 + 2 * 16442.95) / 3).epsilon(1e-6));
    }
  }
}

TEST_CASE("a user's law that says nothing of the third direction is named, and costs no output") {
  const Mat<2> F{{1.01, 0.0}, {0.0, 1.0}};
  for (const char* formulation : {"tl_displacement", "tl_stress_points"}) {
    const Simulation<2> s = deformed<2>(formulation, std::make_shared<Springs>(rubber), F);
    CHECK(s.cauchy_stress(0)(0, 0) == doctest::Approx(0.01 * rubber.E));
    CHECK_THROWS_WITH_AS(s.full_cauchy_stress(0), doctest::Contains("\"springs\" does not give it"),
                         InputError);
    CHECK(StressRecovery<2>(s).cauchy_stress()[0](0, 0) == doctest::Approx(0.01 * rubber.E));
    if (!has_field_output()) continue;
    const auto file = std::filesystem::temp_directory_path() / "taut_full_stress_test.vtkhdf";
    CHECK_NOTHROW(write_vtkhdf(file.string(), s));
    CHECK(std::filesystem::remove(file));
    MaterialParameters sheet = rubber;
    sheet.plane = Plane::stress;
    CHECK(deformed<2>(formulation, std::make_shared<Springs>(sheet), F).full_cauchy_stress(0)(2, 2) == 0);
  }
}
