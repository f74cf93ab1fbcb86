#pragma once
/// \file
/// One run of the swinging cube, by a method of the library or by finite elements.

#include <convergence/swinging_cube.hpp>
#include <lib/results.hpp>
#include <optional>
#include <string>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {

struct CubeSpec {
  Method method = with_defaults({});
  int intervals = 8;  ///< 1/h
  double jitter = 0;  ///< in spacings
  unsigned seed = 1;
  bool undeformed = false;  ///< start a quarter period early, from the undeformed state at full speed
  bool recover = false;     ///< also measure the stress that StressRecovery makes, where there is one
};

struct CubeRun {
  Row row;  ///< all columns but quantity and its value; status ok, broke or skipped
  std::optional<CubeErrors> snapshot;  ///< at SwingingCube::snapshot()
  std::optional<CubeErrors> quarter;   ///< root mean square over the quarter period, of 16 instants
  std::string why;                     ///< skipped: what the method said; broke: how
};

/// Runs for a quarter period. Laws in rate form know no initial strain: they start a quarter period earlier,
/// from the undeformed state at full speed, and swing through the same states; their stress is Cauchy's.
/// Others do so where the spec says it: the exact displacement, as it is given at t = 0, is no state that a
/// discrete body swings through; next to faces it then rings. A method that cannot take the cube is skipped.
/// Times leave out what looking at the errors takes.
CubeRun run_cube(const CubeSpec& spec, int threads);
/// The finite elements of hexahedral_fem.hpp on the same nodes; the spec's method is left aside. Recovered
/// stress: fits of the means of the elements.
CubeRun run_cube_fem(const CubeSpec& spec, int threads);
/// Relative L2 error over the free components of the acceleration at t = 0; nothing when the first step
/// breaks.
std::optional<double> initial_acceleration_error(const CubeSpec& spec);

}  // namespace taut::bench
