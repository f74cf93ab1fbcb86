#include <taut/integrators/leapfrog.hpp>
#include <taut/integrators/vector_ops.hpp>

namespace taut {

void Leapfrog::advance(Dynamics& system, double t, double dt) {
  if (system.constraints_project()) complete(system, t);
  const auto x = system.positions(), v = system.velocities();
  const auto a = system.accelerations();
  if (owed_ == 0)
    kick_drift(x, v, a, dt / 2, dt);
  else
    kick_kick_drift(x, v, a, owed_, dt / 2, dt);
  // From here on the velocities are those of the half step.
  system.constrain_velocities(t + dt / 2);
  system.constrain_positions(t + dt);
  if (!system.others().empty()) {
    system.update_rates(t + dt);
    for (const Block& block : system.others()) add_scaled(block.value, dt, block.rate);
  }
  system.update_accelerations(t + dt);
  owed_ = dt / 2;
}

void Leapfrog::complete(Dynamics& system, double t) {
  if (owed_ == 0) return;
  add_scaled(system.velocities(), owed_, system.accelerations());
  owed_ = 0;
  system.constrain_velocities(t);
}

}  // namespace taut
