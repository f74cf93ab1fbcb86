#pragma once
/// \file
/// How time steps follow a bound that changes with the state.

#include <limits>

namespace taut {

/// Constant steps for as long as can be. A step that follows the state of an undamped body swings with its
/// vibrations, and a symplectic scheme then pumps energy into them (Skeel, BIT 33, 1993; Wright, J. Comput.
/// Phys. 140, 1998): a free neo-Hookean square gained twentyfold in 10^4 steps. So the step falls at once
/// where the bound demands it, but rises only to the least bound of the latest `window` steps, and only where
/// that pays.
class StepControl {
 public:
  /// The next step [s] under the bound [s] of the present state; never above it.
  double next(double bound);

 private:
  // Vibrations slower than this many steps per period have no stake in the step's error.
  static constexpr int window = 256;
  static constexpr double worthwhile = 1.1;
  double step_ = 0, least_ = std::numeric_limits<double>::infinity();
  int seen_ = 0;
};

}  // namespace taut
