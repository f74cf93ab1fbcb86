#pragma once
/// \file
/// A mechanical system as time integrators see it.

#include <span>
#include <vector>

namespace taut {

/// A variable that evolves by its rate: d value / dt = rate.
struct Evolved {
  std::span<double> value;
  std::span<const double> rate;
};

/// Positions, velocities and further evolved variables of a system, as flat arrays whose meaning the
/// integrator does not know: positions may be counted from anywhere, such as the places at rest. Arrays stay
/// where they are for the life of the object.
class Dynamics {
 public:
  virtual ~Dynamics() = default;

  virtual std::span<double> positions() = 0;
  virtual std::span<double> velocities() = 0;
  virtual std::span<const double> accelerations() = 0;
  /// Mass of each velocity component (same length); for energies and norms.
  virtual std::span<const double> masses() = 0;
  /// Variables besides positions and velocities; empty for most total Lagrangian forms.
  virtual std::vector<Evolved> evolved() { return {}; }

  /// Accelerations at time t from positions, velocities and evolved variables.
  virtual void update_accelerations(double t) = 0;
  /// Rates of the evolved variables from positions and velocities.
  virtual void update_rates(double /*t*/) {}
  /// Imposes the constraints on positions and velocities at time t (end of a drift), or on velocities only
  /// (after a kick).
  virtual void constrain_positions(double /*t*/) {}
  virtual void constrain_velocities(double /*t*/) {}
  /// Largest step [s] that the CFL condition allows in the present state (factor 1).
  virtual double stable_step() const = 0;
};

}  // namespace taut
