#pragma once
/// \file
/// Bodies as shapes, and shapes as particle clouds.

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <taut/core/types.hpp>
#include <vector>

namespace taut {

/// A region of space. Copyable (shared, immutable description). Dimensions in metres.
template <int D>
class Shape {
 public:
  Shape(std::function<bool(const Vec<D>&)> contains, const Vec<D>& min, const Vec<D>& max);
  bool contains(const Vec<D>& X) const { return contains_(X); }
  const Vec<D>& min() const { return min_; }  ///< corner of a box around the region
  const Vec<D>& max() const { return max_; }
  Shape operator|(const Shape& other) const;  ///< union
  Shape operator-(const Shape& other) const;  ///< difference

 private:
  std::function<bool(const Vec<D>&)> contains_;
  Vec<D> min_, max_;
};

template <int D>
Shape<D> box(const Vec<D>& min, const Vec<D>& max);
template <int D>
Shape<D> sphere(const Vec<D>& centre, double radius);  ///< a disc in 2D, an interval in 1D
/// Ring (2D) or hollow sphere (3D) between two radii.
template <int D>
Shape<D> ring(const Vec<D>& centre, double inner_radius, double outer_radius);
/// Straight round cylinder between two points.
Shape<3> cylinder(const Vec<3>& from, const Vec<3>& to, double radius);
/// Where f(X) < 0, within a box.
template <int D>
Shape<D> implicit(std::function<double(const Vec<D>&)> f, const Vec<D>& min, const Vec<D>& max);

/// Particles of a body in its reference configuration, in the order of their making (the user's ids).
template <int D>
struct Cloud {
  std::vector<Vec<D>> X;     ///< reference positions [m]
  std::vector<double> V;     ///< reference volumes [m^D]
  std::vector<Vec<D>> B;     ///< outward boundary area vectors [m^(D-1)], zero inside; may be empty when unknown
  double dx = 0;             ///< nominal spacing [m]
  std::size_t size() const { return X.size(); }
};

enum class Lattice {
  node_centred,  ///< particles on the faces, tributary volumes and boundary area vectors
  cell_centred   ///< particles at cell centres, equal volumes
};

struct LatticeOptions {
  double dx = 0;                               ///< wanted spacing [m]; each axis is divided into round(length / dx) cells
  Lattice lattice = Lattice::node_centred;
  double jitter = 0;                           ///< move interior points uniformly within ±jitter·dx (0 … 0.4) along each axis
  unsigned seed = 1;
};

/// Fills a shape with a square lattice aligned with its bounding box. Lattice cells count as inside when their centres
/// are; node-centred volumes and area vectors are those of the union of inside cells, so that sum B = 0 and
/// sum X (x) B = (sum V) I hold to round-off.
/// \throws InputError for a spacing that is not positive or larger than the body, jitter out of range, an empty body.
template <int D>
Cloud<D> make_cloud(const Shape<D>& shape, const LatticeOptions& options);

/// Reads particles from a CSV file with a header line. Columns x[,y[,z]] and, optionally, volume and bx[,by[,bz]] (area vectors); `#` starts a comment.
/// Without volumes each particle gets dx^D; `dx` defaults to the median nearest-neighbour distance when 0.
/// \throws InputError as file:line: what, for a missing file or column, a field that is no finite number, a wrong number of fields.
template <int D>
Cloud<D> read_cloud(const std::filesystem::path& file, double dx = 0);

}  // namespace taut
