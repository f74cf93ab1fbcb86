#pragma once
/// \file
/// How health is measured: the parts that formulations call, and the watch over a run.

#include <array>
#include <limits>
#include <string>
#include <taut/core/health.hpp>
#include <taut/core/operators.hpp>
#include <taut/core/particles.hpp>
#include <taut/internal/kernel_table.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <vector>

namespace taut {

template <int D>
struct SimulationImpl;
template <int D>
class Formulation;

inline constexpr double told_only = std::numeric_limits<double>::infinity();

/// A measure that is flagged above `limit`; `at` is an internal index, or -1.
template <int D>
HealthMeasure measure_at(const Particles<D>& p, std::string name, double value, double limit,
                         std::string meaning, Index at);

// Of the forms on pairs in the reference configuration: two sweeps.
/// Linear exactness, spurious force of a constant stress inside and on faces, fewest neighbours, thickness.
template <int D>
void check_pair_operator(const Particles<D>& p, const PairList& pairs, const PairOperator<D>& op,
                         Health& health);
template <int D>
MotionSample pair_motion(const Particles<D>& p, const PairList& pairs, const PairOperator<D>& op);

// Of the updated forms.
/// Spurious force of a constant stress: sum_b V_a V_b 2 grad W_ab, and fewest neighbours.
template <int D>
void check_updated_operator(const Particles<D>& p, const PairList& pairs, const KernelTable& table,
                            Health& health);
/// `touching`: pairs that were adjacent at rest; `rho`: present densities, one value a particle.
template <int D>
MotionSample updated_motion(const Particles<D>& p, const std::vector<std::array<Index, 2>>& touching,
                            const Field& rho);

// What the sweeps above have in common.
/// Which particles have nothing next to them on one side: where areas are known those with some, else those
/// whose neighbours' mean is far off.
template <int D>
std::vector<bool> on_surface(const Particles<D>& p, const PairList& pairs);
/// Forces of a unit stress: those inside, and what those on faces leave of B where that is known.
template <int D>
void add_spurious_forces(const Particles<D>& p, const std::vector<bool>& surface, const Field& force,
                         double limit_inside, double limit_faces, Health& health);
/// Fewest neighbours, and the fewest particles across.
template <int D>
void add_neighbourhoods(const Particles<D>& p, const PairList& pairs, const std::vector<bool>& surface,
                        Health& health);

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
