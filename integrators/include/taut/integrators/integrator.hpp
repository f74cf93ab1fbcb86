#pragma once
/// \file
/// Explicit time integrators for second-order systems.

#include <memory>
#include <string>
#include <string_view>
#include <taut/integrators/dynamics.hpp>
#include <vector>

namespace taut {

/// Advances a system one step at a time.
class Integrator {
 public:
  virtual ~Integrator() = default;
  /// From t to t + dt [s]. Expects accelerations of time t and leaves those of t + dt.
  virtual void step(Dynamics& system, double t, double dt) = 0;
  /// Brings velocities to time t, that of the positions, where the scheme knows them there. To be called
  /// before they are looked at; the next step goes on from either state.
  virtual void complete(Dynamics& /*system*/, double /*t*/) {}
};

/// - "leapfrog": kick–drift–kick; velocities known at whole steps, when completed (Verlet 1967).
/// - "central_difference": velocities live at half steps, u_{n+1} = 2 u_n - u_{n-1} + dt^2 a_n for a constant
/// step. The first step starts from the
///   velocity at t = 0 with half a kick.
/// Both are symplectic, with the same positions for equal steps. Rates of evolved variables are taken with
/// the velocity of the half step. \throws InputError listing the valid names.
std::unique_ptr<Integrator> make_integrator(std::string_view name);
std::vector<std::string> integrator_names();

}  // namespace taut
