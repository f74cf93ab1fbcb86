#pragma once
/// \file
/// Kinematic constraints on sets of particles.

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
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
  /// Displacement [m] of the particle with reference position X at time t [s].
  using Displacement = std::function<double(const Vec<D>& X, double t)>;

  /// Displacement zero along `axis`.
  void fix(std::vector<Index> particles, int axis);
  void prescribe(std::vector<Index> particles, int axis, Displacement displacement);

  /// The same for points that particles carry with them.
  void hold(std::vector<BoundPoint<D>> points, int axis, Displacement displacement = {});
  /// To be called when all is held, with the masses of the particles. \throws InputError as
  /// `HeldPoints::factor`.
  void finish(const Field& mass);

  void apply_to_displacements(double t, const Field& X, Field& u) const;
  /// Velocities of prescribed components are the central difference of their displacement over
  /// t ± `window` [s], which should be a small part of a time step: histories have no scale of their own.
  void apply_to_velocities(double t, const Field& X, Field& v, double window) const;
  /// Constrained components carry no acceleration of their own, so that norms of it are out-of-balance
  /// forces.
  void apply_to_accelerations(Field& a) const;
  bool empty() const {
    return sets_.empty() && std::all_of(held_.begin(), held_.end(), [](const auto& h) { return h.empty(); });
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
          [&](const BoundPoint<D>& point, const Displacement&) { f(point, d); });
  }
  /// Whether any displacement is prescribed: constraints that are fixed do no work.
  bool moving() const {
    for (const Set& set : sets_)
      if (set.displacement) return true;
    bool any = false;
    for (const auto& held : held_)
      held.for_each([&](const BoundPoint<D>&, const Displacement& follow) { any = any || follow; });
    return any;
  }

 private:
  struct Set {
    std::vector<Index> particles;
    int axis;
    Displacement displacement;  // empty: zero
  };
  std::vector<Set> sets_;
  std::array<HeldPoints<D>, D> held_;  // along each axis
};

}  // namespace taut
