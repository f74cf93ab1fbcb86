#include <taut/base/error.hpp>
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

// Velocities live at half steps: v_{n+1/2} = v_{n-1/2} + a_n (dt_{n-1} + dt_n) / 2.
class CentralDifference : public Integrator {
 public:
  void step(Dynamics& system, double t, double dt) override {
    kick_drift(system.positions(), system.velocities(), system.accelerations(), owed_ + dt / 2, dt);
    system.constrain_velocities(t + dt / 2);
    after_drift(system, t + dt, dt);
    owed_ = dt / 2;
  }

 protected:
  double owed_ = 0;  // what velocities lag behind positions
};

// The kick that ends a step and the one that begins the next are one, unless somebody looks in between.
class Leapfrog final : public CentralDifference {
 public:
  void complete(Dynamics& system, double t) override {
    if (owed_ == 0) return;
    add_scaled(system.velocities(), owed_, system.accelerations());
    system.constrain_velocities(t);
    owed_ = 0;
  }
};

}  // namespace

std::vector<std::string> integrator_names() { return {"leapfrog", "central_difference"}; }

std::unique_ptr<Integrator> make_integrator(std::string_view name) {
  if (name == "leapfrog") return std::make_unique<Leapfrog>();
  if (name == "central_difference") return std::make_unique<CentralDifference>();
  throw InputError("unknown integrator \"" + std::string(name) +
                   "\"; valid: " + join_names(integrator_names()));
}

}  // namespace taut
