// The stresses along the axes that a body does not have: those of the three-dimensional law.
#include <doctest/doctest.h>

#include <materials/support.hpp>

using namespace taut;
using namespace taut::test;

namespace {

const MaterialParameters rubber{.E = 2.5e6, .nu = 0.37, .density = 1100};
MaterialParameters sheet(double nu = rubber.nu) {
  MaterialParameters parameters = rubber;
  parameters.nu = nu;
  parameters.plane = Plane::stress;
  return parameters;
}

template <int D>
Mat<3> extended(const Mat<D>& F, double lateral = 1) {
  Mat<3> F3 = Mat<3>::Identity();
  F3.template topLeftCorner<D, D>() = F;
  if (D == 2) F3(2, 2) = lateral;
  return F3;
}

template <int D>
void check_held(const std::string& name) {
  const auto law = hyperelastic<D>(name, rubber);
  const auto whole = hyperelastic<3>(name, rubber);
  Random random(7);
  for (int i = 0; i < 50; ++i) {
    const Mat<D> F = random.deformation<D>(0.4, 2.5);
    const Mat<3> sigma = law->cauchy_stress(F), exact = whole->cauchy_stress(extended<D>(F));
    CHECK((sigma - exact).norm() < 1e-12 * exact.norm());
    CHECK(sigma(2, 2) != 0);
  }
}

/// The stretch of the thickness at which the three-dimensional law has no stress across it, by bisection.
double free_thickness(const Hyperelastic<3>& whole, const Mat<2>& F) {
  double low = 0.05, high = 20;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    (stress(whole, extended<2>(F, middle))(2, 2) > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

/// P = 5e5 (F - I), and nothing else.
class Springs final : public Hyperelastic<2> {
 public:
  explicit Springs(const MaterialParameters& parameters) : Hyperelastic<2>(parameters) {}
  std::string_view name() const override { return "springs"; }
  void stress(const StressBlock<2>& block) const override {
    CHECK(block.P_lateral == nullptr);
    for (int c = 0; c < 4; ++c)
      for (int p = 0; p < block.n; ++p) {
        const std::size_t at = static_cast<std::size_t>(c) * block.stride + static_cast<std::size_t>(p);
        block.P[at] = 5e5 * (block.F[at] - (c == 0 || c == 3));
      }
  }
  double wave_speed(double, double, double, double) const override { return Material<2>::wave_speed(); }
};

}  // namespace

TEST_CASE("plane and uniaxial strain: the whole Cauchy stress is that of the 3D law held still") {
  for (const std::string& name : hyperelastic_names()) {
    CAPTURE(name);
    check_held<1>(name);
    check_held<2>(name);
    check_held<3>(name);
  }
}

TEST_CASE("plane stress: the whole Cauchy stress is that of the 3D law with a free thickness") {
  for (const std::string& name : hyperelastic_names())
    for (const double nu : {-0.2, 0.0, 0.37}) {
      CAPTURE(name);
      CAPTURE(nu);
      const auto law = hyperelastic<2>(name, sheet(nu));
      const auto whole = hyperelastic<3>(name, sheet(nu));
      Random random(11);
      for (int i = 0; i < 20; ++i) {
        const Mat<2> F = random.deformation<2>(0.8, 1.3);
        const Mat<3> sigma = law->cauchy_stress(F);
        const Mat<3> exact = whole->cauchy_stress(extended<2>(F, free_thickness(*whole, F)));
        CHECK((sigma - exact).norm() < 1e-10 * (exact.norm() + 1e-3 * rubber.E));
        CHECK(sigma(2, 2) == 0);
      }
    }
}

TEST_CASE("uniaxial strain: lateral stresses in closed form") {
  const double mu = rubber.mu(), lambda = rubber.lambda();
  for (const double s : {0.5, 0.9, 1.1, 1.8}) {
    CAPTURE(s);
    const Mat<1> F(s);
    const double E = (s * s - 1) / 2;
    const auto check = [&](const char* name, double axial, double lateral) {
      CAPTURE(name);
      const Mat<3> sigma = hyperelastic<1>(name, rubber)->cauchy_stress(F);
      CHECK(sigma(0, 0) == doctest::Approx(axial).epsilon(1e-12));
      CHECK(sigma(1, 1) == doctest::Approx(lateral).epsilon(1e-12));
      CHECK(sigma(2, 2) == sigma(1, 1));
      CHECK((sigma - Mat<3>(sigma.diagonal().asDiagonal())).norm() == 0);
    };
    check("linear_elastic", (lambda + 2 * mu) * (s - 1), lambda * (s - 1));
    check("st_venant_kirchhoff", s * (lambda + 2 * mu) * E, lambda * E / s);
    check("corotated_svk", (lambda + 2 * mu) * E, lambda * E / s);
    check("neo_hookean", (mu * (s * s - 1) + lambda * std::log(s)) / s, lambda * std::log(s) / s);
  }
}

TEST_CASE("asking for the lateral state changes neither P nor the energy") {
  for_each_mode([](auto dimension, Plane plane) {
    constexpr int D = dimension;
    if constexpr (D < 3) {
      MaterialParameters parameters = rubber;
      parameters.plane = plane;
      Random random(3);
      for (const std::string& name : hyperelastic_names()) {
        const auto law = hyperelastic<D>(name, parameters);
        const Mat<D> F = random.deformation<D>(0.7, 1.5);
        const Evaluation<D> alone = evaluate(*law, F);
        Field in(lanes, D * D), P(lanes, D * D), energy(lanes, 1), P_lateral(lanes, 3 - D),
            F_lateral(lanes, 3 - D);
        for (int p = 0; p < lanes; ++p) in.set_mat<D>(p, F);
        StressBlock<D> block{lanes, in.stride(), in.data(), P.data()};
        block.P_lateral = P_lateral.data();
        block.F_lateral = F_lateral.data();
        law->stress(block);
        CHECK((P.mat<D>(5) - alone.P).norm() == 0);
        CHECK(P_lateral.data()[5] == P_lateral.data()[0]);
        CHECK((F_lateral.data()[5] == 1) == (plane == Plane::strain));
        if (!law->has_energy()) continue;
        block.energy = energy.data();
        law->stress(block);
        CHECK(energy.data()[5] == alone.energy);
      }
    }
  });
}

TEST_CASE("hypoelastic: the whole Cauchy stress is that of the 3D law") {
  const auto law = [](auto dimension, const MaterialParameters& parameters) {
    constexpr int D = dimension;
    return std::dynamic_pointer_cast<const Hypoelastic<D>>(make_material<D>("hypoelastic", parameters));
  };
  using One = std::integral_constant<int, 1>;
  using Two = std::integral_constant<int, 2>;
  using Three = std::integral_constant<int, 3>;
  Random random(5);
  for (int i = 0; i < 20; ++i) {
    const double rho = rubber.density * random(0.7, 1.4), p = rubber.bulk() * (rho / rubber.density - 1);
    Mat<3> s = Mat<3>::Zero();
    s.topLeftCorner<2, 2>() = random.matrix<2>(1e6);
    s(1, 0) = s(0, 1);
    s(2, 2) = -s(0, 0) - s(1, 1);
    const Mat<3> exact = s - p * Mat<3>::Identity();
    const double close = 1e-14 * (exact.norm() + std::abs(p));
    CHECK((law(Three{}, rubber)->cauchy_stress(s, rho) - exact).norm() < close);
    CHECK((law(Two{}, rubber)->cauchy_stress(s.topLeftCorner<2, 2>(), rho) - exact).norm() < close);
    Mat<3> membrane = exact;
    membrane(2, 2) = 0;
    CHECK((law(Two{}, sheet())->cauchy_stress(s.topLeftCorner<2, 2>(), rho) - membrane).norm() < close);

    const Vec<3> axial = s(0, 0) * Vec<3>(1, -0.5, -0.5) - p * Vec<3>::Ones();
    CHECK((law(One{}, rubber)->cauchy_stress(s.topLeftCorner<1, 1>(), rho).diagonal() - axial).norm() <
          close);
  }
  Mat<3> sheared = Mat<3>::Zero();
  sheared << 1e6, 2e6, 3e6, 2e6, 4e6, 5e6, 3e6, 5e6, -5e6;
  CHECK((law(Three{}, rubber)->cauchy_stress(sheared, rubber.density) - sheared).norm() < 1e-8);
}

TEST_CASE("a law that says nothing of the third direction: unknown in plane strain, zero in plane stress") {
  const Mat<2> F{{1.1, 0.2}, {0.0, 0.9}};
  const Mat<2> in_plane = 5e5 * (F - Mat<2>::Identity()) * F.transpose() / F.determinant();
  const Mat<3> held = Springs(rubber).cauchy_stress(F), loose = Springs(sheet()).cauchy_stress(F);
  CHECK((held.topLeftCorner<2, 2>() - in_plane).norm() < 1e-9);
  CHECK(std::isnan(held(2, 2)));
  CHECK((loose.topLeftCorner<2, 2>() - in_plane).norm() < 1e-9);
  CHECK(loose(2, 2) == 0);
}
