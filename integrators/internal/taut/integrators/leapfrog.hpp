#pragma once
/// \file
/// Leapfrog.

#include <taut/integrators/integrator.hpp>

namespace taut {

/// Kick–drift–kick. The last kick of a step waits for the next step, which makes it on its way over memory,
/// unless somebody looks at the velocities before. It is made by itself in either case: the bits are the
/// same.
class Leapfrog final : public Integrator {
 public:
  void complete(Dynamics& system, double t) override;
  StepLimits limits() const override { return leapfrog_limits; }

 private:
  void advance(Dynamics& system, double t, double dt) override;

  double owed_ = 0;  // what velocities lag behind positions [s]
};

}  // namespace taut
