#pragma once
/// \file
/// Points with fields as a VTKHDF file, whatever made them.

#include <span>
#include <string>
#include <vector>

namespace taut::internal {

/// A named quantity of every point: `components` values a point, point by point.
struct PointArray {
  std::string name;
  int components = 1;
  std::vector<double> values;
};

/// Writes points (x, y, z a point) as vertices of an unstructured grid, VTKHDF version 1.0, under a temporary
/// name first. Besides `arrays` every point gets its number as "id". \throws RunError when the file cannot be
/// written or this build has no HDF5.
void write_vtkhdf_points(const std::string& file, std::span<const double> xyz,
                         std::span<const PointArray> arrays);

}  // namespace taut::internal
