#pragma once
/// \file
/// Symmetry planes by mirrored neighbours.

#include <taut/base/fields.hpp>
#include <taut/base/types.hpp>
#include <vector>

namespace taut {

/// Images of particles beyond symmetry planes X[axis] = const. Image k stands at index `begin() + k` of every
/// field and copies the particle `master(k)`, reflected.
template <int D>
class MirrorMap {
 public:
  struct Plane {
    int axis;
    double at;  ///< coordinate of the plane [m]
    int side;   ///< 0: the body lies above it, 1: below
  };

  MirrorMap() = default;
  /// Images of all points within `reach` of the planes (edges and corners of several planes included), the
  /// points on a plane excepted: they are their own images. `tolerance` tells what lies on a plane.
  MirrorMap(const std::vector<Plane>& planes, const std::vector<Vec<D>>& points, double reach,
            double tolerance);

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
  Index begin_ = 0;
  std::vector<Index> master_;
  std::vector<std::uint8_t> flips_;  // bit d: coordinate d is reflected
  std::vector<Vec<D>> twice_plane_;  // x' = twice_plane + S x
};

}  // namespace taut
