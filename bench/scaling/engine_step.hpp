#pragma once
/// \file
/// Steps of taut itself, through its public interface.

#include <memory>
#include <taut/core/geometry.hpp>
#include <taut/core/simulation.hpp>

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

  EngineStep(const Cloud<D>& cloud, Method method);

  /// Particle-steps a second with `threads` threads, after one step that is not counted.
  /// \throws RunError when the body breaks.
  double rate(int threads, double least_seconds);
  /// Accelerations of the state that the body starts in, in the order of the cloud [m/s^2]. Total Lagrangian
  /// only.
  const std::vector<Vec<D>>& start_accelerations() const { return start_accelerations_; }
  /// Step of the total Lagrangian body [s].
  double step() const { return dt_; }

  const Simulation<D>& simulation() const { return simulation_; }
  double bytes_per_particle() const;
  double neighbours() const;

 private:
  bool updated_;
  Simulation<D> simulation_;
  double dt_ = 0;
  std::vector<Vec<D>> start_accelerations_;
};

}  // namespace taut::bench
