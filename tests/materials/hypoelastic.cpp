#include <doctest/doctest.h>

#include <functional>
#include <taut/base/error.hpp>
#include <taut/materials/hypoelastic_bar.hpp>

#include "support.hpp"

using namespace taut;
using namespace taut::test;

namespace {

template <int D>
constexpr int row(int c) {
  constexpr int rows[6] = {0, 1, 2, 1, 0, 0};
  return D == 2 && c == 2 ? 0 : rows[c];
}
template <int D>
constexpr int column(int c) {
  constexpr int columns[6] = {0, 1, 2, 2, 2, 1};
  return D == 2 && c == 2 ? 1 : columns[c];
}

template <int D>
struct State {
  Mat<D> s = Mat<D>::Zero();
  double rho = 0;
};

/// A hypoelastic material, one particle at a time.
template <int D>
class Particle {
 public:
  explicit Particle(const MaterialParameters& parameters)
      : material_(make_material<D>("hypoelastic", parameters)) {}

  State<D> at_rest() const { return {Mat<D>::Zero(), material_->density()}; }

  State<D> rate(const State<D>& state, const Mat<D>& L) const {
    Fields f(state, L);
    law().rate(f.block);
    return {f.symmetric(f.s_rate), f.rho_rate.data()[3]};
  }

  Mat<D> stress(const State<D>& state) const {
    Fields f(state, Mat<D>::Zero());
    law().stress(f.block);
    return f.symmetric(f.sigma);
  }

  /// Fourth-order Runge–Kutta steps under the velocity gradient L(t), 0 <= t <= 1.
  State<D> integrate(State<D> y, const std::function<Mat<D>(double)>& L, int steps) const {
    const double h = 1.0 / steps;
    const auto step = [](const State<D>& a, const State<D>& k, double x) {
      return State<D>{a.s + x * k.s, a.rho + x * k.rho};
    };
    for (int i = 0; i < steps; ++i) {
      const double t = i * h;
      const State<D> k1 = rate(y, L(t)), k2 = rate(step(y, k1, h / 2), L(t + h / 2));
      const State<D> k3 = rate(step(y, k2, h / 2), L(t + h / 2)), k4 = rate(step(y, k3, h), L(t + h));
      y = step(step(step(step(y, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
    }
    return y;
  }

  const Material<D>& material() const { return *material_; }

 private:
  struct Fields {
    Fields(const State<D>& state, const Mat<D>& L_)
        : L(lanes, D * D), s(lanes, sym_components<D>), rho(lanes, 1), s_rate(s), rho_rate(rho), sigma(s) {
      for (int p = 0; p < lanes; ++p) {
        L.set_mat<D>(p, L_);
        for (int c = 0; c < sym_components<D>; ++c) s.component(c)[p] = state.s(row<D>(c), column<D>(c));
        rho.data()[p] = state.rho;
      }
      block = {lanes,      L.stride(),    L.data(),        s.data(),
               rho.data(), s_rate.data(), rho_rate.data(), sigma.data()};
    }
    static Mat<D> symmetric(const Field& f) {
      Mat<D> m;
      for (int c = 0; c < sym_components<D>; ++c)
        m(row<D>(c), column<D>(c)) = m(column<D>(c), row<D>(c)) = f.component(c)[3];
      return m;
    }
    Field L, s, rho, s_rate, rho_rate, sigma;
    RateBlock<D> block;
  };
  const Hypoelastic<D>& law() const { return dynamic_cast<const Hypoelastic<D>&>(*material_); }
  std::shared_ptr<const Material<D>> material_;
};

MaterialParameters parameters(double nu, Plane plane = Plane::strain) { return {3.0, nu, 2.0, plane}; }

/// Checks that a bar drawn to the exact state's strains carries the exact state's stress, and nothing on its
/// free sides.
template <int D>
void check_bar(double nu, Plane plane, BarSides sides, double load) {
  CAPTURE(D);
  CAPTURE(nu);
  CAPTURE(load);
  const MaterialParameters p = parameters(nu, plane);
  const auto exact = hypoelastic_bar(p, sides, load);
  REQUIRE(exact);
  Mat<D> L = Mat<D>::Zero();
  L(0, 0) = std::log(exact->stretch);
  for (int i = 1; i < D; ++i) L(i, i) = std::log(exact->transverse_stretch);
  const Particle<D> particle(p);
  const State<D> end = particle.integrate(
      particle.at_rest(), [&](double) { return L; }, 200);
  const Mat<D> sigma = particle.stress(end);
  CHECK(sigma(0, 0) == doctest::Approx(exact->stress).epsilon(1e-9));
  CHECK(p.density / end.rho == doctest::Approx(exact->volume_ratio).epsilon(1e-9));
  for (int i = 1; i < D; ++i) CHECK(std::abs(sigma(i, i)) < 1e-8 * std::abs(exact->stress) + 1e-12);
  const int free_sides = sides == BarSides::free ? 2 : sides == BarSides::plane_strain ? 1 : 0;
  CHECK(sigma(0, 0) * std::pow(exact->transverse_stretch, free_sides) == doctest::Approx(load).epsilon(1e-8));
}

}  // namespace

TEST_CASE("integrating the rates reproduces the exact bar") {
  for (const double nu : {-0.3, 0.0, 0.3, 0.45})
    for (const double load : {-3.0, -0.5, 1e-3, 0.3}) {
      check_bar<1>(nu, Plane::strain, BarSides::confined, load);
      check_bar<2>(nu, Plane::strain, BarSides::plane_strain, load);
      check_bar<2>(nu, Plane::stress, BarSides::free, load);
      check_bar<3>(nu, Plane::strain, BarSides::free, load);
    }
}

TEST_CASE("the exact bar follows Hooke's law at small load, and has a largest load in tension") {
  const MaterialParameters p = parameters(0.3);
  const double small = 1e-7;
  CHECK(hypoelastic_bar(p, BarSides::free, small * p.E)->stretch - 1 == doctest::Approx(small).epsilon(1e-5));
  CHECK(hypoelastic_bar(p, BarSides::free, small * p.E)->transverse_stretch - 1 ==
        doctest::Approx(-p.nu * small).epsilon(1e-5));
  CHECK(hypoelastic_bar(p, BarSides::plane_strain, small * p.E)->stretch - 1 ==
        doctest::Approx(small * (1 - p.nu * p.nu)).epsilon(1e-5));
  CHECK(hypoelastic_bar(p, BarSides::confined, small * p.E)->stretch - 1 ==
        doctest::Approx(small * p.E / (p.lambda() + 2 * p.mu())).epsilon(1e-5));
  CHECK(hypoelastic_bar(p, BarSides::free, 0)->stretch == 1);

  // Nearly incompressible: stress E ln(stretch) on an area of 1 / stretch has its maximum E / e at the
  // stretch e.
  const MaterialParameters rubber = parameters(0.49999);
  const double largest = rubber.E / std::exp(1.0);
  CHECK(hypoelastic_bar(rubber, BarSides::free, 0.999 * largest));
  CHECK(hypoelastic_bar(rubber, BarSides::free, 0.999 * largest)->stretch < std::exp(1.0));
  CHECK_FALSE(hypoelastic_bar(rubber, BarSides::free, 1.001 * largest));
  CHECK(hypoelastic_bar(rubber, BarSides::free, -5 * largest));

  // Whether there is a largest load turns at K / mu = (1 + sqrt(2 / 3))², nu = 0.3624.
  CHECK(hypoelastic_bar(parameters(0.362), BarSides::free, 100));
  CHECK_FALSE(hypoelastic_bar(parameters(0.363), BarSides::free, 100));

  CHECK_THROWS_AS(hypoelastic_bar(p, BarSides::free, std::nan("")), InputError);
  CHECK_THROWS_AS(hypoelastic_bar({-1, 0.3, 1}, BarSides::free, 1), InputError);
}

TEST_CASE("a stressed particle that turns keeps its stress in its own frame") {
  Random random(41);
  const auto check = [&](auto dimension, Plane plane) {
    constexpr int D = decltype(dimension)::value;
    const Particle<D> particle(parameters(0.3, plane));
    const Mat<D> stretch = random.matrix<D>(0.4);
    const State<D> before = particle.integrate(
        particle.at_rest(), [&](double) -> Mat<D> { return stretch; }, 50);
    Mat<D> W = 3 * random.matrix<D>(1);
    W = (W - W.transpose()).eval();
    const State<D> after = particle.integrate(
        before, [&](double) { return W; }, 400);
    // exp(W) by scaling and squaring of its series.
    Mat<D> Q = Mat<D>::Identity(), term = Mat<D>::Identity();
    for (int i = 1; i < 20; ++i) {
      term = (term * W / (1024 * i)).eval();
      Q += term;
    }
    for (int i = 0; i < 10; ++i) Q = (Q * Q).eval();
    REQUIRE((Q * Q.transpose() - Mat<D>::Identity()).norm() < 1e-12);
    REQUIRE(before.s.norm() > 0.1);
    CHECK((after.s - Q * before.s * Q.transpose()).norm() < 1e-7 * before.s.norm());
    CHECK(after.rho == before.rho);
  };
  for (int trial = 0; trial < 5; ++trial) {
    check(std::integral_constant<int, 2>{}, Plane::strain);
    check(std::integral_constant<int, 2>{}, Plane::stress);
    check(std::integral_constant<int, 3>{}, Plane::strain);
  }
}

TEST_CASE("plane stress: no stress through the thickness along any path") {
  Random random(43);
  for (const double nu : {-0.2, 0.0, 0.3, 0.49}) {
    const MaterialParameters p = parameters(nu, Plane::stress);
    const Particle<2> sheet(p);
    for (int trial = 0; trial < 5; ++trial) {
      const Mat<2> A = random.matrix<2>(0.5), B = random.matrix<2>(0.5);
      const State<2> end = sheet.integrate(
          sheet.at_rest(), [&](double t) -> Mat<2> { return A + t * B; }, 100);
      const double pressure = p.bulk() * (end.rho / p.density - 1), s_33 = -end.s.trace();
      CHECK(end.s.norm() > 0.05);
      CHECK(std::abs(s_33 - pressure) < 1e-7 * (1 + p.bulk()));
      CHECK((sheet.stress(end) - end.s + pressure * Mat<2>::Identity()).norm() < 1e-13 * (1 + p.bulk()));
    }
  }
}

TEST_CASE("one law in all dimensions: 1D and plane strain are the 3D law with the other strains zero") {
  Random random(47);
  const Particle<1> line(parameters(0.3));
  const Particle<2> plane(parameters(0.3));
  const Particle<3> solid(parameters(0.3));
  const Mat<2> A = random.matrix<2>(0.5), B = random.matrix<2>(0.5);
  Mat<3> A3 = Mat<3>::Zero(), B3 = Mat<3>::Zero(), C3 = Mat<3>::Zero();
  A3.topLeftCorner<2, 2>() = A;
  B3.topLeftCorner<2, 2>() = B;
  C3(0, 0) = 0.4;
  const Mat<2> sigma2 = plane.stress(plane.integrate(
      plane.at_rest(), [&](double t) -> Mat<2> { return A + t * B; }, 20));
  const State<3> end3 = solid.integrate(
      solid.at_rest(), [&](double t) -> Mat<3> { return A3 + t * B3; }, 20);
  CHECK((solid.stress(end3).topLeftCorner<2, 2>() - sigma2).norm() < 1e-13);
  CHECK(std::abs(end3.s.trace()) < 1e-14);
  const double sigma1 = line.stress(line.integrate(
      line.at_rest(), [&](double) { return Mat<1>(0.4); }, 20))(0, 0);
  const double sigma3 = solid.stress(solid.integrate(
      solid.at_rest(), [&](double) { return C3; }, 20))(0, 0);
  CHECK(sigma1 == doctest::Approx(sigma3).epsilon(1e-13));
}

TEST_CASE("no plane wave of a coaxially strained hypoelastic body is faster than the bound") {
  for (const double nu : {-0.3, 0.0, 0.3, 0.49}) {
    Random random(53);
    for_each_mode([&](auto dimension, Plane plane) {
      constexpr int D = decltype(dimension)::value;
      CAPTURE(nu);
      CAPTURE(D);
      CAPTURE(static_cast<int>(plane));
      const Particle<D> particle(parameters(nu, plane));
      for (const auto& [low, high] : {std::pair{0.9, 1.1}, {0.6, 1.0}, {1.0, 1.8}, {0.6, 1.8}})
        for (int trial = 0; trial < 8; ++trial) {
          const Vec<D> stretches = random.stretches<D>(low, high);
          const Mat<D> L = stretches.array().log().matrix().asDiagonal(), F = stretches.asDiagonal();
          const State<D> state = particle.integrate(
              particle.at_rest(), [&](double) { return L; }, 40);
          const Mat<D> sigma = particle.stress(state);
          const double J = particle.material().density() / state.rho;  // three-dimensional
          double fastest = 0;
          for (int i = 0; i < 30 + D; ++i) {
            const Vec<D> N = i < D ? Vec<D>(Vec<D>::Unit(i)) : random.direction<D>();
            // P = J sigma F^-T: with dF = a N^T, dP N = J (dsigma - sigma dL^T + tr(dL) sigma) g, g = F^-T N.
            const Vec<D> g = F.inverse().transpose() * N;
            Mat<D> A;
            for (int k = 0; k < D; ++k) {
              const Mat<D> dL = Vec<D>::Unit(k) * g.transpose();
              const State<D> rate = particle.rate(state, dL);
              const double trace = -rate.rho / state.rho;
              const Mat<D> dsigma = rate.s - particle.material().parameters().bulk() * rate.rho /
                                                 particle.material().density() * Mat<D>::Identity();
              A.col(k) = J * (dsigma - sigma * dL.transpose() + trace * sigma) * g;
            }
            fastest = std::max(fastest, std::sqrt(spectral_radius<D>(A) / particle.material().density()));
          }
          const double J_in_plane = F.determinant();
          const auto& m = particle.material();
          CHECK(fastest <=
                1.0001 * m.wave_speed(stretches.minCoeff(), stretches.maxCoeff(), J_in_plane, J_in_plane));
          CHECK(fastest <= 1.0001 * m.wave_speed(low, high));
          if (low == 0.9)
            CHECK(m.wave_speed(stretches.minCoeff(), stretches.maxCoeff(), J_in_plane, J_in_plane) <=
                  1.3 * fastest);
        }
    });
  }
}

TEST_CASE("rates may be written over their input") {
  const auto material = make_material<3>("hypoelastic", parameters(0.3));
  const auto& law = dynamic_cast<const Hypoelastic<3>&>(*material);
  Random random(59);
  Field L(16, 9), s(16, 6), rho(16, 1), s_rate(16, 6), rho_rate(16, 1);
  for (double& v : L.flat()) v = random(-1, 1);
  for (double& v : s.flat()) v = random(-1, 1);
  for (double& v : rho.flat()) v = random(1, 3);
  law.rate({16, 16, L.data(), s.data(), rho.data(), s_rate.data(), rho_rate.data(), nullptr});
  law.rate({16, 16, L.data(), s.data(), rho.data(), s.data(), rho.data(), nullptr});
  for (int c = 0; c < 6; ++c)
    for (int p = 0; p < 16; ++p) CHECK(s.component(c)[p] == s_rate.component(c)[p]);
  for (int p = 0; p < 16; ++p) CHECK(rho.data()[p] == rho_rate.data()[p]);
}
