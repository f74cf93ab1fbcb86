#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/formulations/health_sweeps.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

namespace {

template <int D>
Eigen::Vector3d as_3d(const Vec<D>& v) {
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  for (int d = 0; d < D; ++d) w[d] = v[d];
  return w;
}

}  // namespace

namespace {

/// Kinetic energy about the centre of mass [J].
template <int D>
double own_motion(const Particles<D>& p) {
  Vec<D> momentum = Vec<D>::Zero();
  double mass = 0, squares = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.n); ++i) {
    const double m = p.m.component(0)[i];
    const Vec<D> v = p.v.template vec<D>(i);
    momentum += m * v;
    mass += m;
    squares += m * v.squaredNorm();
  }
  return 0.5 * std::max(0.0, squares - momentum.squaredNorm() / mass);
}

}  // namespace

template <int D>
HealthBalance<D> HealthBalance<D>::of(const SimulationImpl<D>& s) {
  HealthBalance b;
  b.known = true;
  const Particles<D>& p = s.particles;
  Vec<D> centre = Vec<D>::Zero();
  double mass = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.n); ++i) {
    centre += p.m.component(0)[i] * (p.X.template vec<D>(i) + p.u.template vec<D>(i));
    mass += p.m.component(0)[i];
  }
  centre /= mass;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.n); ++i) {
    const double m = p.m.component(0)[i];
    const Vec<D> v = p.v.template vec<D>(i), x = p.X.template vec<D>(i) + p.u.template vec<D>(i);
    b.kinetic += 0.5 * m * v.squaredNorm();
    b.momentum += m * v;
    b.absolute += m * v.norm();
    const Eigen::Vector3d spin = m * as_3d<D>(x - centre).cross(as_3d<D>(v));
    for (std::size_t d = 0; d < 3; ++d) b.angular[d] += spin[static_cast<int>(d)];
    b.absolute_angular += m * (x - centre).norm() * v.norm();
  }
  b.load = s.loads.work(s.time, p.m, p.u);
  try {
    b.strain = s.formulation->strain_energy();
    b.has_strain = true;
  } catch (const InputError&) {
    b.has_strain = false;
  }
  return b;
}

template <int D>
HealthWatch<D>::HealthWatch(SimulationImpl<D>& simulation, bool undamped) : s_(simulation) {
  // Images move, and loads on planes count twice; what is prescribed does work.
  conserves_ = undamped && s_.loads.constant() && !s_.constraints.moving() && s_.planes.empty();
  free_ = conserves_ && s_.loads.empty() && s_.constraints.empty();
  if (!conserves_)
    s_.balance = {};
  else if (!s_.balance.known)
    s_.balance = HealthBalance<D>::of(s_);
}

template <int D>
void HealthWatch<D>::look() {
  const MotionSample now = s_.formulation->motion();
  if (!now.known) return;
  const auto up = [](double& to, double value) { to = std::max(to, value); };
  up(worst_.rough, now.rough);
  // Moving bodies have as much energy in their motion; those that spin or fly may have next to none in
  // strains, so that any wave would count. The sums are twice the energy.
  up(worst_.strain, std::max(now.strain, 2 * own_motion(s_.particles)));
  up(worst_.mean, now.mean);
  up(worst_.density, now.density);
  up(worst_.interface, now.interface);
  if (now.worst > worst_.worst) worst_.worst = now.worst, worst_.worst_at = now.worst_at;
  if (now.gap > worst_.gap) worst_.gap = now.gap, worst_.gap_at = now.gap_at;
  worst_.known = true;
}

template <int D>
void HealthWatch<D>::add_motion(Health& health) const {
  if (!worst_.known) return;
  const Particles<D>& p = s_.particles;
  // Below the round-off of displacements (of single-precision operators where they are large) there is
  // nothing rough.
  double farthest = 0;
  for (int d = 0; d < D; ++d)
    for (Index i = 0; i < p.n; ++i) farthest = std::max(farthest, std::abs(p.u.component(d)[i]));
  const bool noise = worst_.mean < 1e-13 * farthest / p.dx;
  const double roughness = noise ? 0 : worst_.rough / worst_.strain;
  health.measures.push_back(
      measure_at(p, "health_roughness", roughness, s_.formulation->rough_limit(),
                 "energy of the motion of neighbours that gradients do not see, over the strain energy",
                 worst_.worst_at));
  health.measures.push_back(measure_at(
      p, "health_nonaffine_max", worst_.worst, told_only,
      "largest motion between neighbours that gradients do not see, over their distance", worst_.worst_at));
  health.measures.push_back(measure_at(p, "health_nonaffine_mean", worst_.mean, told_only,
                                       "the same, root mean square", no_particle));
  if (worst_.interface >= 0 && !noise)
    health.measures.push_back(measure_at(
        p, "health_interface", worst_.interface / worst_.strain, 0.07,
        "strain energy of particles next to a material of another stiffness, over all", no_particle));
  if (worst_.density >= 0)
    health.measures.push_back(
        measure_at(p, "health_density_error", worst_.density, 0.02,
                   "volume from the density over that from the positions, less one (rms)", no_particle));
  if (worst_.gap >= 0)
    health.measures.push_back(measure_at(p, "health_gap", worst_.gap, 1.5,
                                         "largest distance of particles that touched, over what it was",
                                         worst_.gap_at));
}

template <int D>
void HealthWatch<D>::add_balances(Health& health) const {
  if (!conserves_) return;
  const HealthBalance<D> now = HealthBalance<D>::of(s_), &then = s_.balance;
  const double scale =
      std::max({now.kinetic, then.kinetic, now.strain, then.strain, std::abs(now.load), std::abs(then.load)});
  if (scale > 0) {
    const double change = now.total() - then.total();
    // Forms without a stored energy start without stress: what they keep is what is missing.
    health.measures.push_back(
        measure_at(s_.particles, "health_energy_error",
                   (now.has_strain ? std::abs(change) : std::max(0.0, change)) / scale, 0.05,
                   now.has_strain ? "change of kinetic, strain and load energy together, over the largest"
                                  : "kinetic energy that comes from nowhere, over the largest energy",
                   no_particle));
  }
  if (!free_) return;
  if (const double size = std::max(now.absolute, then.absolute); size > 0)
    health.measures.push_back(
        measure_at(s_.particles, "health_momentum_error", (now.momentum - then.momentum).norm() / size, 1e-3,
                   "change of momentum of a free body, over the sum of all sizes", no_particle));
  if (const double size = std::max(now.absolute_angular, then.absolute_angular); D > 1 && size > 0)
    health.measures.push_back(measure_at(
        s_.particles, "health_spin_error",
        std::hypot(now.angular[0] - then.angular[0], now.angular[1] - then.angular[1],
                   now.angular[2] - then.angular[2]) /
            size,
        1e-2, "change of angular momentum of a free body, over the sum of all sizes", no_particle));
}

template <int D>
Health HealthWatch<D>::finish(bool at_rest, bool broke) {
  Health health = s_.health_of_setup;
  if (broke) return health;
  if (at_rest) worst_ = {};  // the way to it does not matter
  look();
  add_motion(health);
  add_balances(health);
  return health;
}

#define TAUT_INSTANTIATE(D)         \
  template struct HealthBalance<D>; \
  template class HealthWatch<D>;
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
