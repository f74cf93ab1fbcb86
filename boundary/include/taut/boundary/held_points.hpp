#pragma once
/// \file
/// Constraints on points between and beyond particles.

#include <memory>
#include <taut/base/fields.hpp>
#include <taut/base/types.hpp>
#include <taut/boundary/prescribed_motion.hpp>
#include <unordered_map>
#include <vector>

namespace taut {

/// A point whose displacement is a linear combination of those of particles.
template <int D>
struct BoundPoint {
  struct Term {
    Index particle;
    double weight;
  };
  Vec<D> X;                 ///< in the reference configuration [m]
  std::vector<Term> terms;  ///< of one component of the displacement
  Index number = 0;  ///< tells points apart: holding one again along the same axis replaces what held it
};

/// One component of the displacement of points that do not stand on particles: walls where the body ends half
/// a spacing beyond its outermost particles. What holds them are forces along the rows of the weights C, so
/// that they do no work but that of a prescribed motion: a -= M^-1 C^T (C M^-1 C^T)^-1 C a. The matrix is
/// factored once.
template <int D>
class HeldPoints {
 public:
  HeldPoints();
  ~HeldPoints();
  HeldPoints(HeldPoints&&) noexcept;
  HeldPoints& operator=(HeldPoints&&) noexcept;

  void add(std::vector<BoundPoint<D>> points, PrescribedMotion<D> motion);
  bool empty() const { return points_.empty(); }
  /// Calls f(point, motion) for each point.
  template <class F>
  void for_each(F&& f) const {
    for (std::size_t k = 0; k < points_.size(); ++k) f(points_[k], motions_[set_[k]]);
  }

  /// Factors the system for particles of the given masses (one value a particle); those for which `fixed` is
  /// set do not give way. Points that only fixed particles carry are left out. \throws InputError where
  /// holding some points says the same thing twice, which leaves their forces open.
  void factor(const Field& mass, const std::vector<char>& fixed);

  /// Moves `values` (one component of a field) by the least change, weighted by mass, that makes the points
  /// follow `now(motion)`, a `PrescribedMotion::Now` that is asked for once a motion. Not by two threads.
  template <class At>
  void project(double* values, At&& now) const {
    if (row_point_.empty()) return;
    for (std::size_t m = 0; m < motions_.size(); ++m) now_[m] = now(motions_[m]);
    for (std::size_t r = 0; r < defect_.size(); ++r) {
      const std::size_t k = row_point_[r];
      defect_[r] = now_[set_[k]](points_[k].X);
      for (const auto& term : points_[k].terms) defect_[r] -= term.weight * values[term.particle];
    }
    correct(values);
  }

 private:
  void correct(double* values) const;

  std::vector<BoundPoint<D>> points_;
  std::vector<std::size_t> set_;  // of each point: which motion it follows
  std::vector<PrescribedMotion<D>> motions_;
  std::unordered_map<Index, std::size_t> place_;  // of each point by its number
  std::vector<std::size_t> row_point_;            // the points that take part
  // Of the last projection, kept for their memory.
  mutable std::vector<typename PrescribedMotion<D>::Now> now_;
  mutable std::vector<double> defect_;
  struct System;
  std::unique_ptr<System> system_;
};

}  // namespace taut
