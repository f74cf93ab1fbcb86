#pragma once
/// \file
/// How a body is looked at: from far away, in one direction; and how light falls on it.

#include <array>
#include <vector>

namespace taut::bench {

using Point = std::array<double, 3>;

/// A parallel projection. Vertical edges (z) stand upright; of a view along z, those along y.
class View {
 public:
  /// \param from where the viewer stands; of any length
  explicit View(const Point& from);

  /// To the right, upwards, and towards the viewer [m].
  Point project(const Point& x) const;
  /// Axis that goes to the right and upwards, both in their own direction; −1: none does.
  int right_axis() const { return axis_of(right_); }
  int up_axis() const { return axis_of(up_); }
  /// Whether the picture has axes to read coordinates from.
  bool is_straight() const { return right_axis() >= 0 && up_axis() >= 0; }
  /// Brightness, 0 … 1, of a surface with this normal (any length).
  double brightness(const Point& normal) const;

 private:
  static int axis_of(const Point& direction);

  Point right_{}, up_{}, towards_{};
};

/// What points away from the neighbours of each particle, in units of `spacing` [m]: the outward normal of
/// the surface; nearly zero inside. Particles whose neighbours clump are looked at in part.
std::vector<Point> outward(const std::vector<Point>& x, double spacing);

}  // namespace taut::bench
