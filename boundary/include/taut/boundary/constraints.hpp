#pragma once
/// \file
/// Kinematic constraints on sets of particles.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <taut/base/fields.hpp>
#include <taut/base/types.hpp>
#include <taut/boundary/held_points.hpp>
#include <vector>

namespace taut {

/// Displacement components that do not follow from the forces. Later constraints win where sets overlap.
template <int D>
class Constraints {
 public:
  /// Displacement zero along `axis`.
  void fix(std::vector<Index> particles, int axis);
  void prescribe(std::vector<Index> particles, int axis, PrescribedMotion<D> motion);

  /// The same for points that particles carry with them.
  void hold(std::vector<BoundPoint<D>> points, int axis, PrescribedMotion<D> motion = {});
  /// To be called when all is held, with the masses of the particles. \throws InputError as
  /// `HeldPoints::factor`.
  void finish(const Field& mass);

  void apply_to_displacements(double t, const Field& X, Field& u) const;
  /// `window` [s] is for velocities that are not given, see `PrescribedMotion`.
  void apply_to_velocities(double t, const Field& X, Field& v, double window) const;
  /// Constrained components carry no acceleration of their own, so that norms of it are out-of-balance
  /// forces.
  void apply_to_accelerations(Field& a) const;
  bool empty() const { return sets_.empty() && !projects(); }
  /// Whether points are held between particles: velocities then follow from what they were.
  bool projects() const {
    return std::any_of(held_.begin(), held_.end(), [](const auto& h) { return !h.empty(); });
  }

  /// Bit d is set where component d of a particle is held or prescribed, for the first n particles.
  std::vector<std::uint8_t> held(Index n) const;
  /// Whether a prescribed displacement is another one at any of the times than it is at t.
  bool move_later(double t, std::span<const double> times, const Field& X) const;
  /// Calls f(point, axis) for each held point.
  template <class F>
  void for_each_point(F&& f) const {
    for (int d = 0; d < D; ++d)
      held_[static_cast<std::size_t>(d)].for_each(
          [&](const BoundPoint<D>& point, const PrescribedMotion<D>&) { f(point, d); });
  }
  /// Whether any displacement is prescribed: constraints that are fixed do no work.
  bool moving() const {
    for (const Set& set : sets_)
      if (set.motion.moves()) return true;
    bool any = false;
    for (const auto& held : held_)
      held.for_each(
          [&](const BoundPoint<D>&, const PrescribedMotion<D>& motion) { any = any || motion.moves(); });
    return any;
  }

 private:
  struct Set {
    std::vector<Index> particles;
    int axis;
    PrescribedMotion<D> motion;
  };
  // field = now(motion)(X) for all that is constrained.
  template <class Now>
  void apply(const Field& X, Field& field, Now&& now) const;

  std::vector<Set> sets_;
  std::array<HeldPoints<D>, D> held_;  // along each axis
};

}  // namespace taut
