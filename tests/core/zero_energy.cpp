// Pairwise control of zero-energy modes: silent in what the gradients see, stiff against what they do not.
#include <doctest/doctest.h>

#include <Eigen/Geometry>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D>
using Dim = std::integral_constant<int, D>;

constexpr double E = 1e6;

template <int D>
std::shared_ptr<const Material<D>> rubber() {
  return make_material<D>("neo_hookean", {.E = E, .nu = 0.3, .density = 1000});
}

// Forces with the control less those without.
template <int D, class F>
std::vector<Vec<D>> control_forces(const Cloud<D>& cloud, const Method& method, F&& position) {
  Method without = method;
  without.zero_energy_control = 0;
  Bare<D> a(cloud, rubber<D>(), method), b(cloud, rubber<D>(), without);
  a.place(position);
  b.place(position);
  auto forces = a.forces();
  const auto plain = b.forces();
  for (std::size_t i = 0; i < forces.size(); ++i) forces[i] -= plain[i];
  return forces;
}

template <int D>
double largest(const std::vector<Vec<D>>& forces) {
  double value = 0;
  for (const auto& f : forces) value = std::max(value, f.norm());
  return value;
}

}  // namespace

TEST_CASE_TEMPLATE("zero-energy control: no force where the motion is linear", Dimension, Dim<1>, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 1 ? 40 : D == 2 ? 10 : 5, 0.15);
  Mat<3> A3;
  A3 << 1.3, 0.4, -0.2, -0.1, 0.8, 0.3, 0.25, -0.15, 1.1;
  const Mat<D> A = A3.topLeftCorner<D, D>();
  for (const double support : {1.5, 2.4}) {
    const auto forces = control_forces<D>(cloud, {.support_dx = support, .zero_energy_control = 1},
                                          [&](const Vec<D>& X) { return Vec<D>(A * X); });
    CHECK(largest<D>(forces) < 1e-12 * E * std::pow(cloud.dx, D - 1));
  }
}

TEST_CASE_TEMPLATE("zero-energy control: internal forces and moments cancel", Dimension, Dim<1>, Dim<2>,
                   Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 1 ? 40 : D == 2 ? 10 : 5, 0.15);
  Bare<D> body(cloud, rubber<D>(), {.zero_energy_control = 1});
  body.place([](const Vec<D>& X) { return Vec<D>(X + wavy<D>(X, 0.1) + wavy<D>(Vec<D>(29 * X), 0.01)); });
  const auto forces = body.forces();
  Vec<D> sum = Vec<D>::Zero();
  Vec<3> moment = Vec<3>::Zero();
  double amount = 0;
  for (Index i = 0; i < body.n(); ++i) {
    const Vec<D>& f = forces[static_cast<std::size_t>(i)];
    Vec<3> x3 = Vec<3>::Zero(), f3 = Vec<3>::Zero();
    x3.head<D>() = body.x(i);
    f3.head<D>() = f;
    sum += f;
    moment += x3.cross(f3);
    amount += f.norm();
  }
  CHECK(sum.norm() < 1e-13 * amount);
  CHECK(moment.norm() < 1e-13 * amount);
}

TEST_CASE_TEMPLATE("zero-energy control: the zig-zag mode is free without it and pulled back with it",
                   Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  const auto cloud = brick<D>(D == 1 ? 40 : D == 2 ? 12 : 8);
  const double amplitude = 1e-3 * cloud.dx;
  // At R = 1.5 dx central differences see none of a field that changes sign from particle to particle.
  const auto sign = [&](const Vec<D>& X) {
    long parity = 0;
    for (int d = 0; d < D; ++d) parity += std::lround(X[d] / cloud.dx);
    return parity % 2 ? -1.0 : 1.0;
  };
  const auto zigzag = [&](const Vec<D>& X) {
    Vec<D> x = X;
    x[0] += amplitude * sign(X);
    return x;
  };
  const auto inside = [&](const Vec<D>& X) {
    Vec<D> max = Vec<D>::Ones();
    max[0] = 1.5;
    return std::min(X.minCoeff(), (max - X).minCoeff()) > 2.5 * cloud.dx;
  };
  const double scale = E * std::pow(cloud.dx, D - 1) * amplitude / cloud.dx, alpha = 0.1;
  Bare<D> free(cloud, rubber<D>(), {}), held(cloud, rubber<D>(), {.zero_energy_control = alpha});
  // Two neighbours along the axis are 2 A out of place, those across it move at right angles to their pair,
  // and the others have the same sign.
  const Kernel kernel("wendland_c2", D);
  const double W = kernel.value(cloud.dx, 1.5 * cloud.dx / kernel.radius_factor());
  const double expected = 4 * alpha * E * std::pow(cloud.dx, 2 * D - 2) * W * amplitude;
  free.place(zigzag);
  held.place(zigzag);
  const auto without = free.forces(), with = held.forces();
  int checked = 0;
  for (Index i = 0; i < free.n(); ++i) {
    if (!inside(free.X(i))) continue;
    ++checked;
    const auto k = static_cast<std::size_t>(i);
    CHECK(without[k].norm() < 1e-9 * scale);
    CHECK(-with[k][0] * sign(free.X(i)) == doctest::Approx(expected).epsilon(1e-4));
  }
  CHECK(checked > 5);
}
