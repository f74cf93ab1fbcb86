#pragma once
/// \file
/// Kinematic constraints on sets of particles.

#include <functional>
#include <taut/core/fields.hpp>
#include <taut/core/types.hpp>
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

  void apply_to_positions(double t, const Field& X, Field& x) const;
  /// Velocities of prescribed components are the central difference of their displacement.
  void apply_to_velocities(double t, const Field& X, Field& v) const;
  /// Constrained components carry no acceleration of their own, so that norms of it are out-of-balance forces.
  void apply_to_accelerations(Field& a) const;
  bool empty() const { return sets_.empty(); }
  /// Whether any displacement is prescribed: constraints that are fixed do no work.
  bool moving() const {
    for (const Set& set : sets_)
      if (set.displacement) return true;
    return false;
  }

 private:
  struct Set {
    std::vector<Index> particles;
    int axis;
    Displacement displacement;  // empty: zero
  };
  std::vector<Set> sets_;
};

}  // namespace taut
