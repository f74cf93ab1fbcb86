#pragma once
/// \file
/// What lies beyond a body's own particles: images across symmetry planes and in neighbouring periods.

#include <taut/base/fields.hpp>
#include <taut/base/types.hpp>
#include <vector>

namespace taut {

/// Images of particles beyond symmetry planes X[axis] = const and beyond the ends of periods along axes.
/// Image k stands at index `begin() + k` of every field and is what the particle `master(k)` is, reflected
/// and shifted: x' = offset + S x, S a diagonal of signs. What is on a plane across one axis and near the end
/// of a period along another has images of both.
template <int D>
class MirrorMap {
 public:
  struct Plane {
    int axis;
    double at;  ///< coordinate of the plane [m]
    int side;   ///< 0: the body lies above it, 1: below
  };
  /// What lies in [low, low + length) along the axis repeats itself.
  struct Period {
    int axis;
    double low, length;  ///< [m]
  };

  MirrorMap() = default;
  /// Images of all points within `reach` of the planes (edges and corners of several planes included), the
  /// points on a plane excepted: they are their own images. `tolerance` tells what lies on a plane. Likewise
  /// within reach of the ends of periods, as often as it takes.
  MirrorMap(std::vector<Plane> planes, std::vector<Period> periods, const std::vector<Vec<D>>& points,
            double reach, double tolerance);

  /// Finds the images of the first n positions, where these are now. What has left a period is not looked
  /// for: see `wrap`.
  void follow(const Field& x, Index n);
  /// The shift by whole periods that brings x into the box, zero along other axes.
  Vec<D> wrap(const Vec<D>& x) const;
  /// The shortest of all differences of positions that are alike but for whole periods.
  Vec<D> nearest(Vec<D> difference) const;
  const std::vector<Period>& periods() const { return periods_; }
  /// Whether there can be images at all.
  bool possible() const { return !planes_.empty() || !periods_.empty(); }

  bool empty() const { return master_.empty(); }
  Index size() const { return static_cast<Index>(master_.size()); }
  Index begin() const { return begin_; }
  Index master(Index k) const { return master_[k]; }
  /// Bit d: coordinate d of image k is reflected.
  std::uint8_t flips(Index k) const { return flips_[static_cast<std::size_t>(k)]; }
  Vec<D> image(Index k, const Vec<D>& point) const;

  /// Mirrors positions: x' = reflect(x).
  void positions(Field& x) const;
  /// Mirrors vectors (displacements, velocities): v' = S v.
  void vectors(Field& v) const;
  /// Mirrors row-major D×D tensors: T' = S T S.
  void tensors(Field& T) const;
  /// Copies scalars.
  void scalars(Field& f) const;
  /// Mirrors symmetric tensors stored xx | xx, yy, xy | xx, yy, zz, yz, xz, xy.
  void symmetric(Field& s) const;

 private:
  void find(const std::vector<Vec<D>>& points);

  std::vector<Plane> planes_;
  std::vector<Period> periods_;
  double reach_ = 0, tolerance_ = 0;
  Index begin_ = 0;
  std::vector<Index> master_;
  std::vector<std::uint8_t> flips_;  // bit d: coordinate d is reflected
  std::vector<Vec<D>> offset_;
};

}  // namespace taut
