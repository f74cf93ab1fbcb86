#pragma once
/// \file
/// Explicit Runge–Kutta schemes of two arrays.

#include <taut/base/fields.hpp>
#include <taut/integrators/integrator.hpp>
#include <vector>

namespace taut {

/// A stage of a scheme in the form of Shu & Osher (J. Comput. Phys. 77, 1988) that needs nothing but the
/// start of the step and the stage before:
///   U_i = start U_0 + last U_{i-1} + rate dt R(U_{i-1}),   start + last = 1.
struct RungeKuttaStage {
  double start, last, rate;
};

/// An explicit Runge–Kutta scheme. All blocks go through its stages alike. Prescribed velocities are those of
/// the times of the stages, as given functions of time are, so that the order is kept; prescribed positions
/// are imposed at the end of a step.
class RungeKutta : public Integrator {
 public:
  /// The first stage must begin with the start of the step: start + last is all of it.
  RungeKutta(std::vector<RungeKuttaStage> stages, StepLimits limits);
  StepLimits limits() const override { return limits_; }
  std::size_t bytes() const override;

 private:
  void advance(Dynamics& system, double t, double dt) override;

  std::vector<RungeKuttaStage> stages_;
  StepLimits limits_;
  std::vector<AlignedArray<double>> start_;  // of each block
};

/// U* = U + dt R(U), U' = (U + U* + dt R(U*)) / 2. No step is stable for an undamped oscillation: its
/// amplitude grows by the factor (1 + z^4 / 4)^(1/2) a step, z = omega dt. What it states as its limit, z =
/// 0.2, is where that is e^2 in 10^4 steps; at the usual 0.6 of it, 1.3 in 10^4 and 13 in 10^5 steps. Motions
/// that are resolved grow far less. Leapfrog is cheaper where a form does not damp what it does not resolve.
std::unique_ptr<Integrator> make_tvd_rk2();
/// U* = U + dt R(U), U** = 3/4 U + 1/4 (U* + dt R(U*)), U' = 1/3 U + 2/3 (U** + dt R(U**)). Stable up to
/// z = sqrt(3); damps what is below, by 1 - z^4 / 24 a step.
std::unique_ptr<Integrator> make_ssp_rk3();

}  // namespace taut
