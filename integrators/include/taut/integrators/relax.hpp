#pragma once
/// \file
/// Dynamic relaxation to static equilibrium.

#include <cstdint>
#include <functional>
#include <taut/base/fields.hpp>
#include <taut/integrators/dynamics.hpp>
#include <vector>

namespace taut {

/// Central differences with viscous damping that finds its own coefficient: 2 omega, where omega^2 is the
/// Rayleigh quotient of the latest step, -(dx . M da) / (dx . M dx) (Underwood 1983; Papadrakakis 1981). High
/// frequencies die first, the quotient falls to the lowest one that still moves, which is then
/// near-critically damped.
class Relaxation {
 public:
  explicit Relaxation(Dynamics& system);

  /// One damped step of dt [s] to time t + dt, with the limits of leapfrog. Expects the rates of time t.
  void step(double t, double dt);
  /// Euclidean norm of the out-of-balance forces [N] of the present state.
  double force_norm() const { return force_norm_; }
  /// Kinetic energy of the last half step [J].
  double kinetic_energy() const { return kinetic_energy_; }
  /// How far the motion of the lowest moving mode still has to go, over how far it has come: |v| / (omega |x
  /// - x0|).
  double remaining_motion() const { return remaining_; }
  double damping() const { return damping_; }

 private:
  // What a step sums up; in fixed blocks, so that the bits do not depend on the threads.
  struct Sums {
    double vv = 0, va = 0, ff = 0, uu = 0;
  };

  Dynamics& system_;
  AlignedArray<double> start_, previous_;
  std::vector<Sums> partial_;
  double damping_ = 0, force_norm_ = 0, kinetic_energy_ = 0, remaining_ = 1;
};

}  // namespace taut
