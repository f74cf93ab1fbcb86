#pragma once
/// \file
/// Bodies as shapes, and shapes as particle clouds.

#include <array>
#include <filesystem>
#include <functional>
#include <string_view>
#include <taut/core/types.hpp>
#include <vector>

namespace taut {

/// A region of space. Copyable (an immutable description). Dimensions in metres.
template <int D>
class Shape {
 public:
  /// The points for which `contains` holds, none of which may lie outside the box [min, max].
  /// \throws InputError when min < max does not hold along every axis, with finite numbers, or `contains` is
  /// empty.
  Shape(std::function<bool(const Vec<D>&)> contains, const Vec<D>& min, const Vec<D>& max);
  bool contains(const Vec<D>& X) const { return contains_(X); }
  const Vec<D>& min() const { return min_; }  ///< corner of a box around the region
  const Vec<D>& max() const { return max_; }
  Shape operator|(const Shape& other) const;  ///< union
  Shape operator-(const Shape& other) const;  ///< difference; keeps the box of the left one

 private:
  std::function<bool(const Vec<D>&)> contains_;
  Vec<D> min_, max_;
};

/// The axis-aligned box [min, max]. \throws InputError unless min < max along every axis.
template <int D>
Shape<D> box(const Vec<D>& min, const Vec<D>& max);
/// A ball; a disc in 2D, an interval in 1D. \throws InputError unless radius > 0.
template <int D>
Shape<D> sphere(const Vec<D>& centre, double radius);
/// Ring (2D) or hollow sphere (3D) between two radii. \throws InputError unless 0 < inner_radius <
/// outer_radius.
template <int D>
Shape<D> ring(const Vec<D>& centre, double inner_radius, double outer_radius);
/// Straight round cylinder between two points, with flat ends. \throws InputError unless radius > 0 and the
/// points differ.
Shape<3> cylinder(const Vec<3>& from, const Vec<3>& to, double radius);
/// Where f(X) < 0, within a box. \throws InputError unless min < max along every axis, or when f is empty.
template <int D>
Shape<D> implicit(std::function<double(const Vec<D>&)> f, const Vec<D>& min, const Vec<D>& max);

/// A piece of a body's boundary, flat or nearly so.
template <int D>
struct Facet {
  Vec<D> centre;    ///< where a linear field has its mean over the piece [m]
  Vec<D> area;      ///< outward area vector [m^(D-1)]
  Index owner = 0;  ///< the particle whose part of the body ends there
};

/// Particles of a body in its reference configuration, in the order of their making (the user's ids).
template <int D>
struct Cloud {
  std::vector<Vec<D>> X;  ///< reference positions [m]
  std::vector<double> V;  ///< reference volumes [m^D]
  std::vector<Vec<D>> B;  ///< outward boundary area vectors [m^(D-1)], zero inside; may be empty when unknown
  /// Pieces of the boundary where it does not pass through the particles: sum A = 0 and sum x_f (x) A_f =
  /// (sum V) I. Empty where area vectors on the particles say it all, or nothing is known.
  std::vector<Facet<D>> facets;
  std::vector<char>
      extra;      ///< 1 for particles of added layers (`LatticeOptions::layers`); empty when there are none
  /// Cells between particles, for formulations that keep stress on cells: their corners, bit d of a corner's
  /// number telling whether it is the upper one along axis d. Empty unless asked for
  /// (`LatticeOptions::cells`).
  std::vector<std::array<Index, 1 << D>> cells;
  std::vector<double> cell_share;  ///< part of each cell that is body, 0 … 1; empty where all are whole
  double dx = 0;  ///< nominal spacing [m]
  double body_volume = 0;  ///< that of the shape, added layers left out [m^D]; 0 where unknown
  bool guessed_volumes = false;  ///< V is dx^D everywhere for want of better
  std::size_t size() const { return X.size(); }
};

enum class Lattice {
  node_centred,  ///< particles on the faces, tributary volumes and boundary area vectors
  cell_centred   ///< particles at cell centres, equal volumes, no area vectors
};

struct LatticeOptions {
  double dx = 0;  ///< wanted spacing [m]; each axis is divided into round(length / dx) cells
  Lattice lattice = Lattice::node_centred;
  double jitter =
      0;  ///< move interior points uniformly within ±jitter (0 … 0.4) lattice spacings along each axis
  unsigned seed = 1;
  /// Cells added beyond {min, max} of the bounding box along each axis, for clamps: copies of the outermost
  /// cells, column by column, so that the body goes on with the cross-section that it has at that face. Axes
  /// from D on: zero.
  std::array<std::array<int, 2>, 3> layers{};
  /// With 1 a lattice cell is inside when its centre is. With k > 1 it counts by the fraction of k^D sample
  /// points (1 … 16 along each axis) that are inside: volumes of round bodies come closer to the true ones,
  /// at the price of particles of small volume on the surface. The sums below hold all the same.
  int samples = 1;
  bool cells = false;  ///< also list the cells, 2^D corners of four bytes each
};

/// Fills a shape with a square lattice aligned with its bounding box, in lexicographic order, x fastest.
/// Node-centred volumes and area vectors are those of the union of inside cells, so that sum B = 0 and
/// sum X (x) B = (sum V) I hold to round-off. Jitter moves a point only when all cells around it are inside
/// (all cells around its own, for cell-centred ones), so that neither the faces nor the sums change; the
/// displacements depend on the seed and the place in the lattice alone, and are the same on every machine.
/// `Cloud::dx` is the wanted spacing where it divides the box, else the D-th root of a cell's volume. \throws
/// InputError for a spacing that is not positive or that is larger than the body, jitter, layers or samples
/// out of range, a body without an inside cell, more cells than `Index` counts, `cells` of a cell-centred
/// lattice.
template <int D>
Cloud<D> make_cloud(const Shape<D>& shape, const LatticeOptions& options);

/// Whether a reference position lies on a face of the cloud's bounding box, "x_min", "x_max", "y_min", …,
/// within dx/4: the outermost particles of cell-centred clouds. Added layers do not count for the bounding
/// box. \throws InputError for an unknown face, listing the valid ones, or an empty cloud.
template <int D>
std::function<bool(const Vec<D>&)> on_face(const Cloud<D>& cloud, std::string_view face);

/// Reads particles from a CSV file with a header line. Columns x[,y[,z]] and, optionally, volume and
/// bx[,by[,bz]] (area vectors), in any order; `#` starts a comment. Without volumes each particle gets dx^D;
/// `dx` defaults to the median nearest-neighbour distance when 0. \throws InputError as file:line: what, for
/// a missing file or column, a field that is no finite number, a wrong number of fields, a volume that is not
/// positive; also for a dx that is negative or cannot be found.
template <int D>
Cloud<D> read_cloud(const std::filesystem::path& file, double dx = 0);

/// Changes the area vectors of surface particles by the least amount (relative to their size) that makes them
/// enclose the cloud's volume: sum B = 0, sum X (x) B = (sum V) I. Returns the change, sum |dB| / sum |B|.
/// \throws InputError when the surface particles do not span the space.
template <int D>
double close_areas(Cloud<D>& cloud);

/// Finds the surface particles of a cloud without area vectors and gives them some: those whose neighbours
/// within 2.1 dx leave a cone free, with the direction in which there is nothing as normal and one over the
/// density of surface particles as area; closed as above. Meant for bodies sampled up to their surface, two
/// spacings thick or more. Returns the change by closing, as `close_areas`. \throws InputError when no particle is found on a surface, and as `close_areas`.
template <int D>
double estimate_areas(Cloud<D>& cloud);

}  // namespace taut
