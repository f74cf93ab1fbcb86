#include <algorithm>
#include <cmath>
#include <taut/integrators/relax.hpp>
#include <taut/integrators/vector_ops.hpp>

namespace taut {

namespace {
constexpr std::size_t block = 4096;
}

Relaxation::Relaxation(Dynamics& system)
    : system_(system),
      start_(system.positions().size()),
      previous_(system.positions().size()),
      partial_((start_.size() + block - 1) / block) {
  std::copy(system.positions().begin(), system.positions().end(), start_.begin());
}

void Relaxation::step(double t, double dt) {
  const auto x = system_.positions();
  const auto v = system_.velocities();
  const auto a = system_.accelerations();
  const auto m = system_.masses();
  const auto n = static_cast<std::int64_t>(x.size());
  system_.begin_step(t, dt);
  std::copy(a.begin(), a.end(), previous_.begin());

  const double keep = (1 - damping_ * dt / 2) / (1 + damping_ * dt / 2);
  const double kick = dt / (1 + damping_ * dt / 2);
#pragma omp parallel for simd schedule(static) if (n > 65536)
  for (std::int64_t i = 0; i < n; ++i) {
    v[i] = keep * v[i] + kick * a[i];
    x[i] += dt * v[i];
  }
  system_.constrain_velocities(t + dt / 2);
  system_.constrain_positions(t + dt);
  if (!system_.others().empty()) {
    system_.update_rates(t + dt);
    for (const Block& other : system_.others()) add_scaled(other.value, dt, other.rate);
  }
  system_.update_accelerations(t + dt);
  system_.commit();

  // One sweep for all sums of the step.
#pragma omp parallel for schedule(static) if (n > 65536)
  for (std::size_t b = 0; b < partial_.size(); ++b) {
    Sums s;
    for (std::size_t i = b * block; i < std::min(x.size(), (b + 1) * block); ++i) {
      const double u = x[i] - start_[i];
      s.vv += m[i] * v[i] * v[i];
      s.va += m[i] * v[i] * (a[i] - previous_[i]);
      s.ff += m[i] * m[i] * a[i] * a[i];
      s.uu += m[i] * u * u;
    }
    partial_[b] = s;
  }
  Sums sums;
  for (const Sums& s : partial_) {
    sums.vv += s.vv;
    sums.va += s.va;
    sums.ff += s.ff;
    sums.uu += s.uu;
  }
  force_norm_ = std::sqrt(sums.ff);
  kinetic_energy_ = sums.vv / 2;
  const double omega2 = sums.vv > 0 ? std::max(0.0, -sums.va / (dt * sums.vv)) : 0;
  const double omega = std::min(std::sqrt(omega2), 0.5 / dt);
  damping_ = 2 * omega;
  remaining_ = omega > 0 && sums.uu > 0 ? std::sqrt(sums.vv / sums.uu) / omega : 1;
}

}  // namespace taut
