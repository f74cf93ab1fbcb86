#pragma once
/// \file
/// Bodies as shapes, and shapes as particle clouds.

#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <string_view>
#include <taut/base/types.hpp>
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
  Vec<D> centre;    ///< where a linear field has its mean over the piece, as `Cloud::X` [m]
  Vec<D> area;      ///< outward area vector [m^(D-1)]
  Index owner = 0;  ///< the particle whose part of the body ends there
};

template <int D>
struct Occupancy;

/// Particles of a body in its reference configuration, in the order of their making (the user's ids).
template <int D>
struct Cloud {
  std::vector<Vec<D>> X;  ///< reference positions, relative to `origin` [m]
  std::vector<double> V;  ///< reference volumes [m^D]
  std::vector<Vec<D>> B;  ///< outward boundary area vectors [m^(D-1)], zero inside; may be empty when unknown
  /// Pieces of the boundary where it does not pass through the particles: sum A = 0 and sum x_f (x) A_f =
  /// (sum V) I. Empty where area vectors on the particles say it all, or nothing is known.
  std::vector<Facet<D>> facets;
  std::vector<char>
      extra;  ///< 1 for particles of added layers (`LatticeOptions::layers`); empty when there are none
  /// Cells between particles, for formulations that keep stress on cells: their corners, bit d of a corner's
  /// number telling whether it is the upper one along axis d. Empty for other clouds than node-centred
  /// lattices, and where they are not wanted (`LatticeOptions::cells`).
  std::vector<std::array<Index, 1 << D>> cells;
  std::vector<double> cell_share;  ///< part of each cell that is body, 0 … 1; empty where all are whole
  double dx = 0;                   ///< nominal spacing [m]
  std::vector<double>
      spacing;  ///< of each particle [m], for supports that grow with it; empty where all have dx
  /// What X and the centres of facets are relative to [m]. Coordinates far from their origin (maps) have too
  /// few digits left for spacings and displacements, so that bodies there get one of their own.
  Vec<D> origin = Vec<D>::Zero();
  /// The lattice that `make_cloud` filled, which tells total Lagrangian forms what lies between particles and
  /// where materials meet. Without it the boundary does, where areas are given: particles within the support
  /// are no neighbours if the way from one to the other leaves the body (n . X > 0.85 |X| with n the
  /// direction of its area vector, or 0.4 |X| at both). Without either all within the support are. Null for
  /// other clouds. Holds while particles are moved, but not where they are added, removed or reordered: such
  /// a cloud counts as one without a lattice.
  std::shared_ptr<const Occupancy<D>> body;
  double body_volume = 0;        ///< that of the shape, added layers left out [m^D]; 0 where unknown
  bool guessed_volumes = false;  ///< V follows from the points alone
  std::size_t size() const { return X.size(); }
};

enum class Lattice {
  node_centred,  ///< particles on the faces, tributary volumes and boundary area vectors
  cell_centred   ///< particles at cell centres, equal volumes, facets half a cell outside of the outermost
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
  bool cells = true;  ///< node-centred lattices list their cells as well, for stress points: 2^D corners of
                      ///< four bytes each
};

/// Fills a shape with a square lattice aligned with its bounding box, in lexicographic order, x fastest.
/// Cell-centred lattices have facets where filled cells end. Node-centred volumes and area vectors are those
/// of the union of inside cells, so that sum B = 0 and sum X (x) B = (sum V) I hold to round-off. Jitter
/// moves a point only when all cells around it are inside (all cells around its own, for cell-centred ones),
/// so that neither the faces nor the sums change; the displacements depend on the seed and the place in the
/// lattice alone, and are the same on every machine. `Cloud::dx` is the wanted spacing where it divides the
/// box, else the D-th root of a cell's volume.
///
/// A box more than ten of its extents from the origin gets a `Cloud::origin` in its lower corner. Its edges
/// are then as long as they were before its coordinates were rounded, as far as can be told: the multiple of
/// dx, or else the shortest decimal, that this leaves possible. \throws
/// InputError for a spacing that is not positive or that is larger than the body, jitter, layers or samples
/// out of range, a body without an inside cell, more cells than `Index` counts.
template <int D>
Cloud<D> make_cloud(const Shape<D>& shape, const LatticeOptions& options);

/// Whether a reference position (from the origin of the coordinates, not that of the cloud) lies on a face of
/// the cloud's bounding box, "x_min", "x_max", "y_min", …, within dx/4: the outermost particles of
/// cell-centred clouds. Added layers do not count for the bounding box. \throws InputError for an unknown
/// face, listing the valid ones, or an empty cloud.
template <int D>
std::function<bool(const Vec<D>&)> on_face(const Cloud<D>& cloud, std::string_view face);
/// The same for the bounding box of the cloud's facets, within dx/1000: half a cell outside of the outermost
/// particles of cell-centred clouds. \throws InputError also for a cloud without facets.
template <int D>
std::function<bool(const Vec<D>&)> on_facets(const Cloud<D>& cloud, std::string_view face);

/// Reads particles from a CSV file with a header line; `#` starts a comment. Columns, in any order:
/// - x[,y[,z]]: the position.
/// - volume: without it volumes are found as `find_volumes` does, and the body ends at its outermost points.
/// - bx[,by[,bz]]: the particle's area vector, `Cloud::B`.
/// - fx[,fy[,fz]], beside volume and bx: where that area has its centre, `Cloud::facets`; rows with zero area
///   have none. A particle with several facets has a row for each: the same position to the last digit, and
///   an empty volume after the first.
///
/// `dx` defaults, when 0, to the larger one of the median distance to the nearest particle and of V^(1/D) in
/// the middle of the volume (half of the body's volume lies in particles that are larger): the spacing of
/// lattices, node or cell-centred, and of jittered ones that know their volumes. \throws InputError as
/// file:line: what, for a missing file or column, a field that is no finite number, a wrong number of fields,
/// a line of more than a million bytes, a volume that is not positive; also for volumes, coordinates or a dx
/// that overflow, a dx that is negative or cannot be found, and as `find_volumes`. Clouds far from the origin
/// get one of their own, as those of `make_cloud`.
template <int D>
Cloud<D> read_cloud(const std::filesystem::path& file, double dx = 0);

/// Gives the particles of a graded cloud spacings of their own: D-th roots of the volumes around, or the
/// distance of the D-th neighbour where that is more. Leaves `spacing` empty where they differ by less than a
/// factor of 1.6, as in jittered clouds.
template <int D>
void grade_spacing(Cloud<D>& cloud);

/// Gives particles the volumes of the body between them, which ends at the outermost: Delaunay's simplices
/// (those that are not wide: gaps and holes of less than about three spacings are filled, and re-entrant
/// corners cut off by half a spacing), each shared among its corners. Regular lattices get dx^D inside, and
/// halves, quarters, eighths on faces, edges, corners; volumes sum to the body's to round-off. \throws
/// InputError when a particle lies on no part of the body or shares its place with another, and in 2D and 3D
/// when taut was built without Qhull.
template <int D>
void find_volumes(Cloud<D>& cloud);

/// Finds the boundary of a body of which the particles and their volumes are known, and puts it into
/// `Cloud::facets`. Between the particles the body is that of `find_volumes`; where the volumes of a
/// connected part sum to more, its surface is moved outwards, to half a cell before the outermost particles
/// if these are cells' middles, so that it encloses what they sum to; where such particles are jittered the
/// surface is smoothed, and edges are kept. sum A = 0 and sum x (x) A = (sum V) I to round-off. \throws
/// InputError as `find_volumes`, and when the volumes do not belong to a body like that.
template <int D>
void enclose_cloud(Cloud<D>& cloud);

/// Makes facets of area vectors that are known without the places where they act: at the particle, or as far
/// out of it as the body's volume asks for, half a cell where particles are cells' middles. Areas of
/// particles on edges and in corners are split as the neighbours' directions suggest. What is enclosed has
/// the trace of (sum V) I; `close_areas` does the rest. \throws InputError when all areas are zero.
template <int D>
void place_areas(Cloud<D>& cloud);

/// Changes areas by the least amount (relative to their size) that makes them enclose the cloud's volume:
/// sum A = 0, sum x (x) A = (sum V) I, over the facets, or over the area vectors of the particles where there
/// are no facets. Returns the change, sum |dA| / sum |A|. \throws InputError when they do not span the space.
template <int D>
double close_areas(Cloud<D>& cloud);

}  // namespace taut
