#pragma once
// The body that a cloud of points stands for, as simplices between them.

#include <cmath>
#include <taut/base/types.hpp>
#include <taut/geometry/delaunay.hpp>
#include <vector>

namespace taut {

/// A side of a simplex on the body's boundary.
template <int D>
struct BoundaryFace {
  std::array<Index, D> vertex;
  double sign;  ///< of face_area's normal, to point outwards
};

/// Delaunay's simplices without those that are wide against the distances of their corners' neighbours: what
/// is left ends at the outermost points and has the holes and notches that are wider than about three
/// spacings. The boundary is closed: its area vectors sum to zero.
template <int D>
struct BodyMesh {
  std::vector<Simplex<D>> simplices;
  std::vector<unsigned>
      outer;  ///< of each simplex: bit k tells that the side across from corner k is boundary
  std::vector<BoundaryFace<D>> boundary;
  std::vector<int> part;  ///< of each particle: which connected part of the body it belongs to
  int parts = 0;
};

/// `V`, the particles' volumes, may be empty. Where they are known, sum to less than the mesh and belong to a
/// regular cloud, simplices are taken away that no corner has the volume for: in re-entrant corners, and gaps
/// of one spacing. \throws InputError as delaunay, and
/// when a particle lies on no simplex, naming it.
template <int D>
BodyMesh<D> body_mesh(const std::vector<Vec<D>>& X, const std::vector<double>& V);

/// Signed volume of a simplex.
template <int D>
double simplex_volume(const std::vector<Vec<D>>& X, const Simplex<D>& s);

/// Shares of a simplex's corners in it, with sum 1: what is nearest to each, where the circumscribed ball's
/// centre lies inside; negative parts and those beyond a side count, for the simplex across has their
/// counterpart, but not across sides of which `outer` has the bit.
template <int D>
Vec<D + 1> simplex_shares(const std::vector<Vec<D>>& X, const Simplex<D>& s, unsigned outer);

/// The same for a triangle in space.
Vec<3> triangle_shares(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c);

/// Normal of a simplex of D points as long as its area; up to the sign.
template <int D>
Vec<D> face_area(const std::array<Vec<D>, D>& x) {
  if constexpr (D == 1) {
    return Vec<1>(1);
  } else if constexpr (D == 2) {
    const Vec<2> t = x[1] - x[0];
    return {t[1], -t[0]};
  } else {
    const Vec<3> s = x[1] - x[0], t = x[2] - x[0];
    return 0.5 * Vec<3>(s[1] * t[2] - s[2] * t[1], s[2] * t[0] - s[0] * t[2], s[0] * t[1] - s[1] * t[0]);
  }
}

/// Each simplex's volume shared among its corners by simplex_shares, so that regular lattices get their
/// cells, halved on faces. Sums to the volume of the mesh. \throws InputError when a particle gets none,
/// naming it.
template <int D>
std::vector<double> tributary_volumes(const std::vector<Vec<D>>& X, const BodyMesh<D>& mesh);

}  // namespace taut
