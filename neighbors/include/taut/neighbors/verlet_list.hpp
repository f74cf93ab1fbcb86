#pragma once
/// \file
/// Pair lists for moving particles, rebuilt only when they must be.

#include <taut/neighbors/search.hpp>

namespace taut {

/// A pair list with a skin (Verlet, Phys. Rev. 159, 1967): built with the radius R (1 + skin), it holds every
/// pair nearer than R until a particle has moved by half the skin distance skin R. Its pairs may be farther
/// apart than R: who loops over it tests the distance, or relies on a kernel that is zero there.
template <int D>
class VerletList {
 public:
  /// `radius` R [m]; `skin` as a fraction of R (0: rebuilt whenever anything moves).
  /// \throws InputError for a radius that is not positive or a skin that is negative or not finite.
  VerletList(double radius, double skin, SearchOptions options = {});

  /// Brings the list up to date with the positions; true when it was rebuilt, which happens on the first
  /// call, when the largest displacement since the last build exceeds half the skin distance, and when the
  /// number of points changes. \throws InputError as `find_pairs` does.
  bool update(PointView<D> x);
  /// Whether `update` would build the list anew.
  bool due(PointView<D> x);

  const PairList& pairs() const { return pairs_; }
  double radius() const { return radius_; }
  /// The radius that lists are built with, R (1 + skin) [m].
  double reach() const { return radius_ * (1 + skin_); }
  /// How often the list was built, the first time included.
  std::int64_t builds() const { return builds_; }
  /// Largest distance that a particle has moved since the last build, as of the last update [m].
  double largest_displacement() const { return displacement_; }
  std::size_t bytes() const { return pairs_.bytes() + built_at_.bytes(); }

 private:
  double radius_, skin_, displacement_ = 0;
  SearchOptions options_;
  PairList pairs_;
  Field built_at_;
  std::int64_t builds_ = 0;
};

}  // namespace taut
