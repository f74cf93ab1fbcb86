#pragma once
/// \file
/// The largest step of an integrator for what is fastest in a system.

#include <cmath>
#include <limits>
#include <taut/integrators/dynamics.hpp>

namespace taut {

/// Up to where an integrator keeps an undamped oscillation bounded (or nearly so, where it says that).
struct StepLimits {
  double frequency;  ///< angular frequency times step
  double wave;       ///< wave speed times step over the length that resolves waves
};

/// Half the limit on the frequency is that on waves: resolved lengths are those that leapfrog may cross in a
/// step.
constexpr StepLimits step_limits(double frequency) { return {frequency, frequency / 2}; }

/// Leapfrog's: omega dt < 2.
inline constexpr StepLimits leapfrog_limits = step_limits(2);

/// The largest step [s] within both limits; infinite where nothing is known, not a number where that is not.
inline double stable_step(const StepLimits& limits, const Fastest& fastest) {
  double step = std::numeric_limits<double>::infinity();
  if (fastest.frequency != 0) step = limits.frequency / fastest.frequency;
  if (fastest.wave_speed == 0) return step;
  const double of_waves = limits.wave * (fastest.length / fastest.wave_speed);
  return of_waves < step || std::isnan(of_waves) ? of_waves : step;
}

}  // namespace taut
