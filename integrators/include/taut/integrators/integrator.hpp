#pragma once
/// \file
/// Explicit time integrators.

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <taut/integrators/dynamics.hpp>
#include <taut/integrators/step_limits.hpp>
#include <vector>

namespace taut {

/// Advances a system one step at a time. An integrator may remember the system that it has begun with: each
/// needs its own.
class Integrator {
 public:
  virtual ~Integrator() = default;
  /// From t to t + dt [s]. Expects the rates of time t (`Dynamics::update`) and leaves those of t + dt that
  /// its next step needs.
  void step(Dynamics& system, double t, double dt) {
    system.begin_step(t, dt);
    advance(system, t, dt);
    system.commit();
  }
  /// Brings velocities to time t, that of the positions. To be called before they are looked at; the bits of
  /// the steps that follow are the same with it as without.
  virtual void complete(Dynamics& /*system*/, double /*t*/) {}
  /// Steps up to which it is of use.
  virtual StepLimits limits() const = 0;
  /// Memory of what it keeps of the system.
  virtual std::size_t bytes() const { return 0; }

 private:
  virtual void advance(Dynamics& system, double t, double dt) = 0;
};

/// What is known by its name.
struct IntegratorEntry {
  std::string name, line;  ///< `line` documents it
  std::function<std::unique_ptr<Integrator>()> make;
};

/// Those that there are:
/// - "leapfrog": kick–drift–kick (Verlet 1967), symplectic, of second order; omega dt < 2. The kick that ends
/// a
///   step and the one that begins the next are made in one pass, but as two.
/// - "central_difference": the same scheme by its other name, u_{n+1} = 2 u_n - u_{n-1} + dt^2 a_n for a
///   constant step, and the same bits.
/// - "tvd_rk2", "ssp_rk3": the Runge–Kutta schemes of second and third order of Shu & Osher (1988), see
///   `RungeKutta`; omega dt < 0.2 and sqrt(3).
/// In the first two the rates of other variables are taken with the velocity of the half step.
const std::vector<IntegratorEntry>& integrators();
std::vector<std::string> integrator_names();
/// \throws InputError listing the valid names.
std::unique_ptr<Integrator> make_integrator(std::string_view name);
/// Adds one of the program's own. Not while others read the list. \throws InputError when it has no name or
/// nothing that makes it, or the name is taken.
void register_integrator(IntegratorEntry entry);

}  // namespace taut
