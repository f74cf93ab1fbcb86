#include <taut/core/error.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/integrators/vector_ops.hpp>

namespace taut {

namespace {

// Positions, constraints and evolved variables of time t, moved by the half-step velocity in `system`.
void after_drift(Dynamics& system, double t, double dt) {
  system.constrain_positions(t);
  const auto evolved = system.evolved();
  if (!evolved.empty()) {
    system.update_rates(t);
    for (const Evolved& e : evolved) add_scaled(e.value, dt, e.rate);
  }
  system.update_accelerations(t);
}

class Leapfrog final : public Integrator {
 public:
  void step(Dynamics& system, double t, double dt) override {
    kick_drift(system.positions(), system.velocities(), system.accelerations(), dt / 2, dt);
    system.constrain_velocities(t + dt / 2);
    after_drift(system, t + dt, dt);
    add_scaled(system.velocities(), dt / 2, system.accelerations());
    system.constrain_velocities(t + dt);
  }
};

class CentralDifference final : public Integrator {
 public:
  void step(Dynamics& system, double t, double dt) override {
    // The velocity of the last half step is kicked to the next: half of the old step and half of the new.
    const double kick = previous_ < 0 ? dt / 2 : (previous_ + dt) / 2;
    previous_ = dt;
    kick_drift(system.positions(), system.velocities(), system.accelerations(), kick, dt);
    system.constrain_velocities(t + dt / 2);
    after_drift(system, t + dt, dt);
  }

 private:
  double previous_ = -1;
};

}  // namespace

std::vector<std::string> integrator_names() { return {"leapfrog", "central_difference"}; }

std::unique_ptr<Integrator> make_integrator(std::string_view name) {
  if (name == "leapfrog") return std::make_unique<Leapfrog>();
  if (name == "central_difference") return std::make_unique<CentralDifference>();
  throw InputError("unknown integrator \"" + std::string(name) + "\"; valid: " + join_names(integrator_names()));
}

}  // namespace taut
