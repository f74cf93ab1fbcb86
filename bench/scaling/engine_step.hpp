#pragma once
/// \file
/// Steps of taut itself, through its public interface.

#include <memory>
#include <taut/geometry/geometry.hpp>
#include <taut/simulation/simulation.hpp>

namespace taut::bench {

/// The material of all bodies that are timed.
MaterialParameters step_parameters();

/// A smooth displacement without symmetry [m], strains of some 5 %: total Lagrangian bodies start from it.
template <int D>
Vec<D> start_displacement(const Vec<D>& X);

/// A free body of the library that is set up once and stepped many times, with any number of threads.
/// Total Lagrangian bodies vibrate. Updated Lagrangian ones fly, so fast that their pair list is rebuilt in
/// every `rebuild_every`-th step: their rates pay for that.
template <int D>
class EngineStep {
 public:
  static constexpr int rebuild_every = 10;

  /// Sets the body up and makes the first step.
  EngineStep(Cloud<D> cloud, const Method& method);

  /// Particle-steps a second with `threads` threads, after one step that is not counted.
  /// \throws RunError when the body breaks.
  double rate(int threads, double least_seconds);
  /// Accelerations of the state that the body started in, in the order of the cloud [m/s^2].
  const std::vector<Vec<D>>& start_accelerations() const { return start_; }
  /// Length of the first step [s].
  double step() const { return dt_; }

  const Simulation<D>& simulation() const { return simulation_; }
  double bytes_per_particle() const;
  double neighbours() const;
  /// Of the pair list, since set-up.
  std::int64_t rebuilds() const { return rebuilds_; }
  double dx() const { return dx_; }

 private:
  bool updated_;
  double dx_;
  Simulation<D> simulation_;
  std::vector<Vec<D>> start_;
  double dt_ = 0;
  std::int64_t rebuilds_ = 0;
};

}  // namespace taut::bench
