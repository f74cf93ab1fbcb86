#pragma once
// Closed surfaces of line segments or triangles around a body.

#include <array>
#include <taut/geometry/body_mesh.hpp>
#include <taut/geometry/geometry.hpp>
#include <vector>

namespace taut {

/// The surface of a mesh, with vertices that may leave the particles at which they start. However they move,
/// its area vectors sum to zero.
template <int D>
struct Surface {
  std::vector<Vec<D>> x;        ///< vertices
  std::vector<Index> particle;  ///< where each starts
  std::vector<std::array<Index, D>> facet;
  std::vector<double> sign;  ///< of face_area, to point outwards
  std::vector<std::size_t>
      first;  ///< the facets around vertex v are around[first[v]] … around[first[v + 1] - 1]
  std::vector<Index> around;

  Surface(const std::vector<Vec<D>>& X, const BodyMesh<D>& mesh);
  std::size_t size() const { return facet.size(); }
  std::array<Vec<D>, D> corners(std::size_t f) const;
  Vec<D> area(std::size_t f) const { return sign[f] * face_area<D>(corners(f)); }
  Vec<D> centre(std::size_t f) const;
  /// f(g) for each facet g around vertex v.
  template <class F>
  void each_around(std::size_t v, F&& f) const {
    for (std::size_t k = first[v]; k < first[v + 1]; ++k) f(static_cast<std::size_t>(around[k]));
  }
  /// f(g) for each facet g that shares a vertex with facet a, as often as it shares one; a itself included.
  template <class F>
  void each_beside(std::size_t a, F&& f) const {
    for (const Index v : facet[a]) each_around(static_cast<std::size_t>(v), f);
  }
};

/// Moves vertices so that what zigzags around a plane becomes the plane, and edges stay: normals are averaged
/// with those beside them that differ by less than a right angle's two thirds, and vertices follow. Returns
/// by how much normals turned, root mean square [rad].
template <int D>
double smooth(Surface<D>& surface);

/// Values on facets, each averaged with those beside it on the same face.
template <int D>
void smooth(const Surface<D>& surface, std::vector<double>& value);

}  // namespace taut
