#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/base/small_solve.hpp>
#include <taut/geometry/body_mesh.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/geometry/surface.hpp>

namespace taut {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// The shares of a facet's vertices in it.
template <int D>
Vec<D> vertex_shares(const Surface<D>& surface, std::size_t f) {
  if constexpr (D == 3) {
    const auto c = surface.corners(f);
    return triangle_shares(c[0], c[1], c[2]);
  } else {
    return Vec<D>::Constant(1.0 / D);
  }
}

// By how far each facet is to be moved for a cell's half behind it, where particles sit in the middle of
// their cells: half of V over the area that a particle's cell shows, on faces. Up to a common factor.
template <int D>
std::vector<double> half_cells(const Surface<D>& surface, const std::vector<double>& V) {
  constexpr double flat = 0.9, unlike = 5;
  std::vector<double> at_vertex(surface.x.size(), 0), usual(surface.x.size());
  std::vector<Vec<D>> share(surface.size());
  for (std::size_t f = 0; f < surface.size(); ++f) share[f] = vertex_shares<D>(surface, f);
  for (std::size_t v = 0; v < surface.x.size(); ++v) {
    Vec<D> sum = Vec<D>::Zero();
    double total = 0;
    surface.each_around(v, [&](std::size_t f) {
      const auto& own = surface.facet[f];
      const auto k = std::find(own.begin(), own.end(), static_cast<Index>(v)) - own.begin();
      const Vec<D> A = share[f][k] * surface.area(f);
      sum += A;
      total += A.norm();
    });
    const double volume = V[at(surface.particle[v])];
    usual[v] = 0.5 * std::pow(volume, 1.0 / D);
    if (sum.norm() > flat * total)
      at_vertex[v] = std::clamp(0.5 * volume / sum.norm(), usual[v] / unlike, usual[v] * unlike);
  }
  std::vector<double> half(surface.size(), 0), spread;
  for (std::size_t f = 0; f < surface.size(); ++f) {
    int count = 0;
    for (const Index v : surface.facet[f])
      if (at_vertex[at(v)] > 0) {
        half[f] += at_vertex[at(v)];
        ++count;
      }
    if (count) half[f] /= count;
  }
  // Facets between edges alone: as their neighbours on the same face.
  for (int round = 0; round < 3; ++round) {
    spread = half;
    for (std::size_t f = 0; f < surface.size(); ++f) {
      if (half[f] > 0) continue;
      const Vec<D> A = surface.area(f);
      double sum = 0;
      int count = 0;
      surface.each_beside(f, [&](std::size_t g) {
        const Vec<D> other = surface.area(g);
        if (!(half[g] > 0) || !(A.dot(other) > flat * A.norm() * other.norm())) return;
        sum += half[g];
        ++count;
      });
      if (count) spread[f] = sum / count;
    }
    half.swap(spread);
  }
  for (std::size_t f = 0; f < surface.size(); ++f)
    if (!(half[f] > 0)) {
      for (const Index v : surface.facet[f]) half[f] += usual[at(v)] / D;
    }
  return half;
}

// Where each vertex goes when its facets move out by `distance`: to the point where they meet then, an edge
// or a corner; along their mean normal where they are nearly parallel.
template <int D>
std::vector<Vec<D>> mitres(const Surface<D>& surface, const std::vector<double>& distance) {
  constexpr double parallel = 0.02, longest = 4;
  std::vector<Vec<D>> way(surface.x.size());
  for (std::size_t v = 0; v < way.size(); ++v) {
    Mat<D> normals = Mat<D>::Zero();
    Vec<D> wanted = Vec<D>::Zero();
    double farthest = 0;
    surface.each_around(v, [&](std::size_t f) {
      const Vec<D> A = surface.area(f);
      const double size = A.norm();
      if (!(size > 0)) return;
      normals += A * A.transpose() / size;
      wanted += distance[f] * A;
      farthest = std::max(farthest, distance[f]);
    });
    const Spectrum<D> eigen = symmetric_eigen<D>(normals);
    way[v].setZero();
    for (int d = 0; d < D; ++d)
      if (eigen.values[d] > parallel * eigen.values[D - 1])
        way[v] += eigen.vectors.col(d) * eigen.vectors.col(d).dot(wanted) / eigen.values[d];
    const double length = way[v].norm();
    if (length > longest * farthest) way[v] *= longest * farthest / length;
  }
  return way;
}

// The part of a segment or triangle that is nearer to X[i] than to the other ones, as a polygon.
template <int D>
std::vector<Vec<D>> nearest_piece(const std::array<Vec<D>, D>& corners, const std::vector<Vec<D>>& X,
                                  std::size_t i) {
  std::vector<Vec<D>> polygon(corners.begin(), corners.end()), cut;
  for (std::size_t j = 0; j < X.size(); ++j) {
    if (j == i) continue;
    // The same numbers for i against j as for j against i, so that pieces meet without a gap.
    const auto beyond = [&](const Vec<D>& x) {
      const std::size_t low = std::min(i, j), high = std::max(i, j);
      const double t = (x - 0.5 * (X[low] + X[high])).dot(X[high] - X[low]);
      return i == low ? t : -t;
    };
    cut.clear();
    const std::size_t n = polygon.size(), sides = D == 2 ? n - 1 : n;
    for (std::size_t k = 0; k < n; ++k) {
      const Vec<D>&a = polygon[k], &b = polygon[(k + 1) % n];
      const double s = beyond(a), t = beyond(b);
      if (s <= 0) cut.push_back(a);
      if (k < sides && ((s < 0 && t > 0) || (s > 0 && t < 0))) cut.push_back(a + (b - a) * (s / (s - t)));
    }
    polygon.swap(cut);
    if (polygon.size() < D) return {};
  }
  return polygon;
}

// Adds a piece to those of the same particle, as one with a parallel piece.
template <int D>
void add_piece(std::vector<Facet<D>>& pieces, std::size_t since, const Facet<D>& piece) {
  constexpr double same = 1e-10;
  const double size = piece.area.norm();
  for (std::size_t k = since; k < pieces.size(); ++k) {
    Facet<D>& other = pieces[k];
    const double its = other.area.norm();
    if ((piece.area / size - other.area / its).norm() > same) continue;
    other.centre = (its * other.centre + size * piece.centre) / (its + size);
    other.area += piece.area;
    return;
  }
  pieces.push_back(piece);
}

// Facets of the surface, each split among its particles and those of the facets beside it by what is nearest.
template <int D>
std::vector<Facet<D>> facets_of(const Surface<D>& surface, const std::vector<Vec<D>>& X) {
  std::vector<Facet<D>> loose;
  std::vector<Index> owners;
  std::vector<Vec<D>> places;
  for (std::size_t f = 0; f < surface.size(); ++f) {
    const std::array<Vec<D>, D> corners = surface.corners(f);
    const double whole = surface.area(f).norm();
    owners.clear();
    surface.each_beside(f, [&](std::size_t g) {
      for (const Index v : surface.facet[g]) owners.push_back(surface.particle[at(v)]);
    });
    std::sort(owners.begin(), owners.end());
    owners.erase(std::unique(owners.begin(), owners.end()), owners.end());
    places.clear();
    for (const Index p : owners) places.push_back(X[at(p)]);
    for (std::size_t k = 0; k < owners.size(); ++k) {
      Facet<D> piece{Vec<D>::Zero(), Vec<D>::Zero(), owners[k]};
      if constexpr (D == 1) {
        piece.centre = corners[0];
        piece.area[0] = surface.sign[f];
      } else {
        const std::vector<Vec<D>> polygon = nearest_piece<D>(corners, places, k);
        double size = 0;
        for (std::size_t j = D - 1; j < polygon.size(); ++j) {
          std::array<Vec<D>, D> part;
          part[0] = polygon[0];
          for (std::size_t m = 1; m < D; ++m) part[m] = polygon[j + m + 1 - D];
          const Vec<D> A = surface.sign[f] * face_area<D>(part);
          Vec<D> middle = Vec<D>::Zero();
          for (const Vec<D>& x : part) middle += x / D;
          piece.area += A;
          piece.centre += A.norm() * middle;
          size += A.norm();
        }
        if (!(size > 1e-14 * whole)) continue;
        piece.centre /= size;
      }
      loose.push_back(piece);
    }
  }
  std::stable_sort(loose.begin(), loose.end(),
                   [](const auto& a, const auto& b) { return a.owner < b.owner; });
  std::vector<Facet<D>> facets;
  for (std::size_t i = 0, since = 0; i < loose.size(); ++i) {
    if (i == 0 || loose[i].owner != loose[i - 1].owner) since = facets.size();
    add_piece<D>(facets, since, loose[i]);
  }
  return facets;
}

// Moves the vertices of one part along `way` until they enclose `wanted`.
template <int D>
void inflate(Surface<D>& surface, const std::vector<std::size_t>& facets,
             const std::vector<std::size_t>& vertices, const std::vector<Vec<D>>& way, double wanted) {
  constexpr double farthest = 2.5;  // half cells
  const std::vector<Vec<D>> start = surface.x;
  double moved = 0, has = 0;
  for (int round = 0; round < 50; ++round) {
    has = 0;
    double slope = 0;
    for (const std::size_t f : facets) {
      const Vec<D> A = surface.area(f);
      has += surface.centre(f).dot(A) / D;
      for (const Index v : surface.facet[f]) slope += way[at(v)].dot(A) / D;
    }
    if (std::abs(has - wanted) <= 1e-15 * wanted) break;
    const double step = (wanted - has) / slope;
    if (!(std::abs(moved + step) < farthest)) {
      moved = 2 * farthest;
      break;
    }
    moved += step;
    for (const std::size_t v : vertices) surface.x[v] = start[v] + moved * way[v];
    if (std::abs(step) < 1e-15) break;
  }
  if (!(std::abs(moved) < farthest))
    throw InputError(
        fmt::format("the volumes sum to {:g}, which is too much for the body between the particles: its "
                    "surface would lie "
                    "more than {:g} spacings outside of the outermost. Check the volumes, or give the "
                    "boundary (bx, by, …)",
                    wanted, farthest / 2));
}

}  // namespace

template <int D>
void enclose_cloud(Cloud<D>& cloud) {
  const BodyMesh<D> mesh = body_mesh<D>(cloud.X, cloud.V);
  Vec<D> middle = Vec<D>::Zero();
  for (const Vec<D>& x : cloud.X) middle += x / static_cast<double>(cloud.size());
  std::vector<Vec<D>> X = cloud.X;
  for (Vec<D>& x : X) x -= middle;
  Surface<D> surface(X, mesh);

  struct Part {
    std::vector<std::size_t> facets, vertices;
    double wanted = 0, has = 0, area = 0, particles = 0;
  };
  std::vector<Part> parts(static_cast<std::size_t>(mesh.parts));
  const auto part_of = [&](Index vertex) -> Part& {
    return parts[static_cast<std::size_t>(mesh.part[at(surface.particle[at(vertex)])])];
  };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Part& p = parts[static_cast<std::size_t>(mesh.part[i])];
    p.wanted += cloud.V[i];
    p.particles += 1;
  }
  for (std::size_t v = 0; v < surface.x.size(); ++v) part_of(static_cast<Index>(v)).vertices.push_back(v);
  for (std::size_t f = 0; f < surface.size(); ++f) {
    Part& p = part_of(surface.facet[f][0]);
    p.facets.push_back(f);
    p.has += surface.centre(f).dot(surface.area(f)) / D;
    p.area += surface.area(f).norm();
  }

  constexpr double round_off = 1e-12, tolerable = 0.05, off_the_particles = 0.1, zigzag = 1e-3;
  bool outside = false, closed = true;
  for (const Part& p : parts) {
    if (!(p.wanted > (1 - tolerable) * p.has))
      throw InputError(fmt::format(
          "the volumes sum to {:g}, less than the {:g} between the particles, which the body holds if it "
          "ends at "
          "the outermost and its gaps are wider than three spacings. Check the volumes, or give the boundary "
          "(bx, by, …)",
          p.wanted, p.has));
    closed = closed && std::abs(p.wanted - p.has) <= round_off * p.wanted;
    const double spacing = std::pow(p.wanted / p.particles, 1.0 / D);
    outside = outside || p.wanted - p.has > off_the_particles * spacing * p.area;
  }
  if (!closed) {
    // Outermost particles that are not on the boundary say roughly where it is; those on it exactly.
    bool rough = false;
    if (outside) {
      Surface<D> smoothed = surface;
      rough = smooth<D>(smoothed) > zigzag;
      if (rough) surface = std::move(smoothed);
    }
    std::vector<double> distance = half_cells<D>(surface, cloud.V);
    if (rough) smooth<D>(surface, distance);
    const std::vector<Vec<D>> way = mitres<D>(surface, distance);
    for (const Part& p : parts) inflate<D>(surface, p.facets, p.vertices, way, p.wanted);
  }
  cloud.facets = facets_of<D>(surface, X);
  for (Facet<D>& f : cloud.facets) f.centre += middle;
}

template void enclose_cloud<1>(Cloud<1>&);
template void enclose_cloud<2>(Cloud<2>&);
template void enclose_cloud<3>(Cloud<3>&);

}  // namespace taut
