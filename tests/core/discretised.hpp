#pragma once
// A body with its pair list and operator, and a body with its formulation, laid open for the tests of the
// core.

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <taut/core/formulation.hpp>
#include <taut/core/operators.hpp>
#include <taut/internal/assembly.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/taut.hpp>
#include <utility>
#include <vector>

namespace taut {

/// Particles, pairs and one operator.
template <int D>
struct Discretised {
  Particles<D> particles;
  PairList pairs;
  PairOperator<D> op;

  Discretised(const Cloud<D>& cloud, Method method) {
    if (method.pair_precision == PairPrecision::automatic)
      method.pair_precision = PairPrecision::single_precision;
    const Kernel kernel(method.kernel, D);
    const double support = method.support_dx * cloud.dx;
    const std::shared_ptr<const Material<D>> material =
        make_material<D>("linear_elastic", {.E = 1, .nu = 0, .density = 1});
    particles = assemble<D>(cloud, {material}, std::vector<std::uint8_t>(cloud.size(), 0), {}, support);
    pairs = find_pairs<D>(points_of<D>(particles.X, particles.total), support);
    op = make_operator<D>(method, particles, pairs, kernel, support / kernel.radius_factor());
  }

  Vec<D> X(Index a) const { return particles.X.template vec<D>(a); }

  /// Gradient of a scalar function at particle a (internal index).
  template <class F>
  Vec<D> gradient(Index a, F&& f) const {
    Vec<D> sum = Vec<D>::Zero();
    pairs.for_each(
        a, [&](Index b, std::int64_t k, int lane) { sum += (f(X(b)) - f(X(a))) * op.vector(k, lane); });
    return op.M.template mat<D>(a) * sum;
  }
};

/// A formulation without a simulation around it: forces of any state. Must stay where it is.
template <int D>
struct Bare {
  Method method;
  Constraints<D> constraints;
  Loads<D> loads;
  Particles<D> particles;
  std::unique_ptr<Formulation<D>> formulation;

  Bare(const Cloud<D>& cloud, std::shared_ptr<const Material<D>> material, Method m,
       const std::vector<typename MirrorMap<D>::Plane>& planes = {})
      : Bare(cloud, {std::move(material)}, std::vector<std::uint8_t>(cloud.size(), 0), std::move(m), planes) {
  }
  Bare(const Cloud<D>& cloud, const std::vector<std::shared_ptr<const Material<D>>>& materials,
       const std::vector<std::uint8_t>& material_of, Method m,
       const std::vector<typename MirrorMap<D>::Plane>& planes = {})
      : method(std::move(m)),
        particles(assemble<D>(cloud, materials, material_of, planes, method.support_dx * cloud.dx)),
        formulation(make_formulation<D>({particles, constraints, loads, method})) {}
  Bare(const Bare&) = delete;
  Bare& operator=(const Bare&) = delete;

  Index n() const { return particles.n; }
  Vec<D> X(Index i) const { return particles.X.template vec<D>(i); }
  Vec<D> x(Index i) const { return particles.x.template vec<D>(i); }
  template <class F>
  void place(F&& position) {
    for (Index i = 0; i < n(); ++i) particles.x.template set_vec<D>(i, position(X(i)));
  }
  /// Forces [N] of the present positions.
  std::vector<Vec<D>> forces() {
    formulation->update_accelerations(0);
    std::vector<Vec<D>> f;
    for (Index i = 0; i < n(); ++i) f.push_back(particles.m.component(0)[i] * particles.a.template vec<D>(i));
    return f;
  }
};

/// Checks the forces on every `stride`-th particle against central differences of the strain energy.
template <int D>
void check_derivative(Bare<D>& body, double dx, Index stride) {
  const auto forces = body.forces();
  double scale = 0;
  for (const auto& f : forces) scale = std::max(scale, f.norm());
  const double step = 1e-5 * dx;
  for (Index i = 0; i < body.n(); i += stride)
    for (int d = 0; d < D; ++d) {
      double& x = body.particles.x.component(d)[i];
      const double at = x;
      x = at + step;
      const double more = body.formulation->strain_energy();
      x = at - step;
      const double less = body.formulation->strain_energy();
      x = at;
      const double error =
          std::abs(-(more - less) / (2 * step) - forces[static_cast<std::size_t>(i)][d]) / scale;
      CHECK(error < 1e-8);
    }
}

/// Checks that forces and their moments about the origin cancel.
template <int D>
void check_balance(Bare<D>& body) {
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

/// Checks that leapfrog stays bounded at 0.95 of the step that the formulation says is stable.
template <int D>
void check_stable_step(const Cloud<D>& cloud, std::shared_ptr<const Material<D>> material,
                       const Method& method) {
  Simulation<D> s(cloud, std::move(material), method);
  // Small and rough: all modes, and no other state than rest.
  s.set_velocity([](const Vec<D>& X) {
    Vec<D> v;
    for (int d = 0; d < D; ++d) v[d] = 1e-3 * std::sin(40 * X.sum() + 70 * X[d] + d);
    return v;
  });
  s.prepare();
  const double energy = s.kinetic_energy();
  const auto result =
      s.run(1e9, {.cfl = 0.95, .progress = [](std::int64_t step, double, double) { return step < 2000; }});
  CHECK(result.status == Status::ok);
  CHECK(s.kinetic_energy() < 2 * energy);
}

/// A box of n spacings of 1 / n along each axis but the first, which is half as long again: no cube hides a
/// swapped axis.
template <int D>
Cloud<D> brick(int n, double jitter = 0, Lattice lattice = Lattice::node_centred) {
  Vec<D> max = Vec<D>::Ones();
  max[0] = 1.5;
  return make_cloud(box<D>(Vec<D>::Zero(), max),
                    {.dx = 1.0 / n, .lattice = lattice, .jitter = jitter, .seed = 7});
}

/// A rotation by `angle` about a fixed skew axis; the plane's in 2D, none in 1D.
template <int D>
Mat<D> rotation(double angle) {
  Mat<D> R = Mat<D>::Identity();
  if constexpr (D == 2) {
    R << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  } else if constexpr (D == 3) {
    const Vec<3> n = Vec<3>(1, 2, -2) / 3.0;
    Mat<3> W;
    W << 0, -n[2], n[1], n[2], 0, -n[0], -n[1], n[0], 0;
    R += std::sin(angle) * W + (1 - std::cos(angle)) * W * W;
  }
  return R;
}

/// A smooth motion without symmetry, of the given size: for states that no special case makes easy.
template <int D>
Vec<D> wavy(const Vec<D>& X, double size) {
  Vec<D> u;
  for (int d = 0; d < D; ++d) {
    double phase = 0.3 + d;
    for (int e = 0; e < D; ++e) phase += (1.7 + 0.9 * e - 0.6 * d) * X[e];
    u[d] = size * std::sin(phase);
  }
  return u;
}

}  // namespace taut
