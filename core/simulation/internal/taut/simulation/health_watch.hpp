#pragma once
/// \file
/// The health of a set-up, and the watch over a run.

#include <array>
#include <cstdint>
#include <taut/base/types.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/formulations/health.hpp>

namespace taut {

template <int D>
struct SimulationImpl;

/// Energies and momenta of a state; those of the planes' other side left out.
template <int D>
struct HealthBalance {
  bool known = false, has_strain = false;
  double kinetic = 0, strain = 0, load = 0;
  Vec<D> momentum = Vec<D>::Zero();
  double absolute = 0;  ///< sum of m |v|
  std::array<double, 3> angular{};
  double absolute_angular = 0;  ///< sum of m |x - centre| |v|

  static HealthBalance of(const SimulationImpl<D>& simulation);
  double total() const { return kinetic + strain - load; }
};

/// Watches one call of run or relax: looks at the state at a few steps and at the end.
template <int D>
class HealthWatch {
 public:
  /// `undamped`: energy is kept where loads do not change. To be made when the state is complete.
  HealthWatch(SimulationImpl<D>& simulation, bool undamped);
  /// After step number `steps`; cheap but for the steps at which it looks.
  void stepped(std::int64_t steps) {
    if (steps < next_) return;
    next_ *= 2;
    look();
  }
  /// Set-up and run together. Velocities must be complete. `at_rest`: the last state alone counts.
  Health finish(bool at_rest, bool broke);

 private:
  void look();
  void add_motion(Health& health) const;
  void add_balances(Health& health) const;

  // A look costs about a step and a half: these keep them within a hundredth of the loop.
  std::int64_t next_ = 1024;
  SimulationImpl<D>& s_;
  bool conserves_ = false;
  bool free_ = false;  // nothing loads or holds the body
  MotionSample worst_;
};

/// The measures of set-up. \throws InputError naming the particle where the operators cannot be used.
template <int D>
Health setup_health(const SimulationImpl<D>& simulation, const Formulation<D>& formulation);

}  // namespace taut
