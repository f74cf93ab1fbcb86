#pragma once
// A body with its pair list and operator, and a body with its formulation, laid open for the tests of the
// core.

#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <memory>
#include <random>
#include <taut/formulations/assembly.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/operators/operators.hpp>
#include <taut/taut.hpp>
#include <utility>
#include <vector>

namespace taut {

/// A dimension as a type, for test case templates.
template <int D>
using Dim = std::integral_constant<int, D>;

/// The vector of lane l in slot k of vectors stored in double precision.
template <int D>
Vec<D> vector_in(const AlignedArray<double>& vectors, std::int64_t k, int lane) {
  Vec<D> g;
  for (int d = 0; d < D; ++d) g[d] = vectors[static_cast<std::size_t>((k * D + d) * lanes + lane)];
  return g;
}

/// Particles, pairs and one operator.
template <int D>
struct Discretised {
  Particles<D> particles;
  PairList pairs;
  PairOperator<D> op;

  Discretised(const Cloud<D>& cloud, Method method) {
    method = with_defaults(method);
    if (method.pair_precision == PairPrecision::automatic)
      method.pair_precision = PairPrecision::single_precision;
    const Kernel kernel(method.kernel, D);
    const double support = method.support_dx * cloud.dx;
    const std::shared_ptr<const Material<D>> material =
        make_material<D>("linear_elastic", {.E = 1, .nu = 0, .density = 1});
    particles = assemble<D>(cloud, {material}, std::vector<std::uint8_t>(cloud.size(), 0), {{}, {}, support});
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

/// Largest |sum_b (V_a M_a G_ab - V_b M_b G_ba) + B_a| over the face of a cell: the force that a unit stress
/// leaves, of vectors in double precision.
template <int D>
double closure_error(const Discretised<D>& b) {
  const auto& p = b.particles;
  const auto& adjoint = b.op.adjoint_d.empty() ? b.op.vectors_d : b.op.adjoint_d;
  double largest = 0;
  for (Index a = 0; a < p.n; ++a) {
    Vec<D> sum = p.B[static_cast<std::size_t>(a)];
    b.pairs.for_each(a, [&](Index c, std::int64_t k, int lane) {
      sum += p.V.component(0)[a] * b.op.M.template mat<D>(a) * b.op.vector(k, lane);
      sum += p.V.component(0)[c] * b.op.M.template mat<D>(c) * vector_in<D>(adjoint, k, lane);
    });
    largest = std::max(largest, sum.norm());
  }
  return largest / std::pow(p.dx, D - 1);
}

/// Angular momentum about the origin, as a vector in space.
template <int D>
Vec<3> angular_momentum(const Simulation<D>& s) {
  Vec<3> L = Vec<3>::Zero();
  for (std::size_t i = 0; i < s.size(); ++i) {
    Vec<3> x = Vec<3>::Zero(), v = Vec<3>::Zero();
    x.head<D>() = s.position(i);
    v.head<D>() = s.velocity(i);
    L += s.mass(i) * x.cross(v);
  }
  return L;
}

/// Checks that a body without loads, moving from its rest shape, keeps momentum to round-off and energy
/// within 0.1 % over ten thousand steps.
template <int D>
void check_free_vibration(Simulation<D>& body) {
  body.prepare();
  const Vec<D> momentum = body.linear_momentum();
  const double energy = body.kinetic_energy();
  const auto result = body.run(
      1e9, {.cfl = 0.5, .progress = [](std::int64_t steps, double, double) { return steps < 10000; }});
  CHECK(result.status == Status::ok);
  CHECK(result.steps == 10000);
  CHECK((body.linear_momentum() - momentum).norm() < 1e-12 * momentum.norm());
  CHECK(body.kinetic_energy() + body.strain_energy() == doctest::Approx(energy).epsilon(1e-3));
}

/// Relative error of the tip of the cantilever of Tran-Duc et al. (2023) at -250 N, nu = 0, against quadratic
/// finite elements.
inline double tip_error(Cloud<2> cloud, const char* operators) {
  Simulation<2> beam(
      std::move(cloud),
      make_material<2>("st_venant_kirchhoff", {.E = 20e6, .nu = 0, .density = 1000, .plane = Plane::stress}),
      Method{.operators = operators});
  beam.clamp(beam.face("x_min"));
  beam.load(beam.face("x_max"), {0, -250});
  CHECK(beam.relax().status == Status::ok);
  return 1e3 * beam.displacement_at({0.2, 0.01}).y() / -47.4404 - 1;
}
/// Its particles, 2 mm apart and jittered.
inline Cloud<2> jittered_cantilever() {
  return make_cloud(box<2>({0, 0}, {0.2, 0.02}), {.dx = 2e-3, .jitter = 0.15});
}

/// A formulation without a simulation around it: forces of any state. Must stay where it is.
template <int D>
struct Bare {
  Method method = with_defaults({});
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
      : method(with_defaults(std::move(m))),
        particles(assemble<D>(cloud, materials, material_of, {planes, {}, method.support_dx * cloud.dx})),
        formulation(make_formulation<D>({particles, constraints, loads, method})) {}
  Bare(const Bare&) = delete;
  Bare& operator=(const Bare&) = delete;

  Index n() const { return particles.n; }
  Vec<D> X(Index i) const { return particles.X.template vec<D>(i); }
  Vec<D> x(Index i) const { return X(i) + particles.u.template vec<D>(i); }
  template <class F>
  void place(F&& position) {
    for (Index i = 0; i < n(); ++i) particles.u.template set_vec<D>(i, position(X(i)) - X(i));
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
      double& u = body.particles.u.component(d)[i];
      const double at = u;
      u = at + step;
      const double more = body.formulation->strain_energy();
      u = at - step;
      const double less = body.formulation->strain_energy();
      u = at;
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
