#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/base/small_solve.hpp>
#include <taut/geometry/body_mesh.hpp>
#include <taut/geometry/spacing.hpp>

namespace taut {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

template <int D>
Mat<D> edges_of(const std::vector<Vec<D>>& X, const Simplex<D>& s) {
  Mat<D> edges;
  for (int d = 0; d < D; ++d) edges.col(d) = X[at(s[static_cast<std::size_t>(d) + 1])] - X[at(s[0])];
  return edges;
}

// The distance to each point's D-th nearest, which on lattices is one spacing in corners too and not the way
// to a twin at a hair's breadth; or V^(1/D) where that is known and larger.
template <int D>
std::vector<double> distances(const std::vector<Vec<D>>& X, const std::vector<double>& V) {
  std::vector<double> distance = nearest_distances<D>(X, D);
  for (std::size_t i = 0; i < V.size(); ++i) distance[i] = std::max(distance[i], std::pow(V[i], 1.0 / D));
  return distance;
}

// The spacing around each point: the distance above, or that of a cubic lattice whose cells have balls as
// wide as those of the simplices at the point, where these are longer than wide; of that the median over the
// nearest points, so that one far off does not vouch for itself.
template <int D>
std::vector<double> local_spacing(const std::vector<Vec<D>>& X, std::vector<double> own,
                                  const std::vector<Simplex<D>>& simplices,
                                  const std::vector<double>& radius) {
  constexpr double longest = 10;  // what is longer than that is no cell but flat
  std::vector<std::vector<double>> radii(X.size());
  for (std::size_t s = 0; s < simplices.size(); ++s)
    for (const Index v : simplices[s])
      if (radius[s] < longest * own[at(v)]) radii[at(v)].push_back(radius[s]);
  for (std::size_t i = 0; i < X.size(); ++i) {
    // A quarter of them: on a face most simplices of a point may lie outside.
    std::vector<double>& r = radii[i];
    if (r.empty()) continue;
    const auto quarter = r.begin() + static_cast<std::ptrdiff_t>(r.size() / 4);
    std::nth_element(r.begin(), quarter, r.end());
    own[i] = std::max(own[i], 2 / std::sqrt(D) * *quarter);
  }
  constexpr std::size_t nearest = 2 * D + 1;
  const std::vector<Index> around = nearest_points<D>(X, nearest);
  std::vector<double> some, spacing(X.size());
  for (std::size_t i = 0; i < X.size(); ++i) {
    some.clear();
    for (std::size_t k = 0; k < nearest; ++k)
      if (const Index n = around[i * nearest + k]; n != no_particle) some.push_back(own[at(n)]);
    const auto middle = some.begin() + static_cast<std::ptrdiff_t>(some.size() / 2);
    std::nth_element(some.begin(), middle, some.end());
    spacing[i] = *middle;
  }
  return spacing;
}

// Points relative to their middle, each moved by a hundred-thousandth of its spacing: on lattices there is no
// telling which of several triangulations is Delaunay's, and the two sides of a cell must not choose
// differently. Everything but the choice is then made with the points as they are.
template <int D>
std::vector<Vec<D>> in_general_position(const std::vector<Vec<D>>& X, const std::vector<double>& spacing) {
  constexpr double amount = 1e-5;
  Vec<D> low = X[0], high = X[0];
  for (const Vec<D>& x : X) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double unit = *std::max_element(spacing.begin(), spacing.end());
  std::mt19937 random(1);
  std::vector<Vec<D>> moved(X.size());
  for (std::size_t i = 0; i < X.size(); ++i) {
    moved[i] = (X[i] - 0.5 * (low + high)) / unit;
    for (int d = 0; d < D; ++d)
      moved[i][d] += amount * (spacing[i] / unit) * (static_cast<double>(random()) / 2147483648.0 - 1);
  }
  return moved;
}

// Neighbour of each simplex across each side, no_particle where there is none.
template <int D>
std::vector<std::array<Index, D + 1>> neighbours_of(const std::vector<Simplex<D>>& simplices) {
  struct Side {
    std::array<Index, D> vertex;
    Index simplex;
    unsigned corner;
  };
  std::vector<Side> sides;
  sides.reserve(simplices.size() * (D + 1));
  for (std::size_t s = 0; s < simplices.size(); ++s)
    for (unsigned k = 0; k <= D; ++k) {
      Side side{{}, static_cast<Index>(s), k};
      for (unsigned j = 0, n = 0; j <= D; ++j)
        if (j != k) side.vertex[n++] = simplices[s][j];
      std::sort(side.vertex.begin(), side.vertex.end());
      sides.push_back(side);
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.simplex < b.simplex;
  });
  std::vector<std::array<Index, D + 1>> neighbour(simplices.size());
  for (auto& n : neighbour) n.fill(no_particle);
  for (std::size_t i = 0; i + 1 < sides.size(); ++i)
    if (sides[i].vertex == sides[i + 1].vertex) {
      neighbour[at(sides[i].simplex)][sides[i].corner] = sides[i + 1].simplex;
      neighbour[at(sides[i + 1].simplex)][sides[i + 1].corner] = sides[i].simplex;
      ++i;
    }
  return neighbour;
}

struct Sets {
  std::vector<Index> parent;
  explicit Sets(std::size_t n) : parent(n) { std::iota(parent.begin(), parent.end(), 0); }
  Index find(Index a) {
    while (parent[at(a)] != a) a = parent[at(a)] = parent[at(parent[at(a)])];
    return a;
  }
  void join(Index a, Index b) { parent[at(find(a))] = find(b); }
};

// Simplices are body up to this radius of their circumscribed ball over the spacing (0.71, 0.87 in square and
// cubic lattices, up to 1.4 where these are jittered by a quarter of their spacing), and where everything
// around them is, up to the second: a hole is wider than that.
constexpr double widest = 1.5, widest_inside = 2.1;

// Which simplices are body.
template <int D>
std::vector<char> choose(const std::vector<std::array<Index, D + 1>>& neighbour,
                         const std::vector<double>& width, double limit) {
  std::vector<char> body(width.size());
  for (std::size_t s = 0; s < width.size(); ++s) body[s] = width[s] <= limit;
  Sets gaps(width.size());
  for (std::size_t s = 0; s < width.size(); ++s)
    for (const Index n : neighbour[s])
      if (n != no_particle && !body[s] && !body[at(n)]) gaps.join(static_cast<Index>(s), n);
  std::vector<char> open(width.size());  // of a gap's first simplex: it is a hole, or leads outside
  for (std::size_t s = 0; s < width.size(); ++s) {
    if (body[s]) continue;
    char& hole = open[at(gaps.find(static_cast<Index>(s)))];
    if (!(width[s] <= limit * widest_inside / widest)) hole = 1;
    for (const Index n : neighbour[s])
      if (n == no_particle) hole = 1;
  }
  std::vector<char> filled = body;
  for (std::size_t s = 0; s < width.size(); ++s)
    if (!body[s] && !open[at(gaps.find(static_cast<Index>(s)))]) filled[s] = 1;
  return filled;
}

// Takes away what the corners' volumes have no room for.
template <int D>
void carve(const std::vector<Vec<D>>& X, const std::vector<double>& V,
           const std::vector<Simplex<D>>& simplices, const std::vector<std::array<Index, D + 1>>& neighbour,
           std::vector<char>& body) {
  constexpr double round_off = 1e-9, regular = 0.02, room = 0.5, flat = 1e-3;
  std::vector<double> volume(simplices.size(), 0), excess(X.size());
  std::vector<Vec<D + 1>> share(simplices.size());
  std::vector<int> count(X.size(), 0);
  double total = 0;
  for (std::size_t i = 0; i < X.size(); ++i) excess[i] = -V[i];
  for (std::size_t s = 0; s < simplices.size(); ++s) {
    if (!body[s]) continue;
    volume[s] = simplex_volume<D>(X, simplices[s]);
    share[s] = volume[s] * simplex_shares<D>(X, simplices[s], 0);
    for (int k = 0; k <= D; ++k) {
      const Index v = simplices[s][static_cast<std::size_t>(k)];
      excess[at(v)] += share[s][k];
      ++count[at(v)];
    }
  }
  std::vector<double> misfit(X.size());
  double allowed = 0;
  for (std::size_t i = 0; i < X.size(); ++i) {
    total += excess[i];
    allowed += round_off * V[i];
    misfit[i] = std::abs(excess[i]) / V[i];
  }
  const auto middle = misfit.begin() + static_cast<std::ptrdiff_t>(misfit.size() / 2);
  std::nth_element(misfit.begin(), middle, misfit.end());
  if (!(total > allowed) || *middle > regular) return;

  std::vector<char> carved(simplices.size(), 0);
  const auto fits = [&](std::size_t s) {
    bool open = false, beside = false, has_room = volume[s] < total + allowed;
    for (const Index n : neighbour[s]) {
      open = open || n == no_particle || !body[at(n)];
      beside = beside || (n != no_particle && carved[at(n)]);
    }
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= D; ++k) {
      const Index v = simplices[s][static_cast<std::size_t>(k)];
      least = std::min(least, V[at(v)]);
      has_room = has_room && count[at(v)] > 1;
    }
    if (!open || !has_room) return false;
    if (volume[s] < flat * least) return beside;
    for (int k = 0; k <= D; ++k)
      if (excess[at(simplices[s][static_cast<std::size_t>(k)])] < room * share[s][k]) return false;
    return true;
  };
  for (bool more = true; more;) {
    more = false;
    for (std::size_t s = 0; s < simplices.size(); ++s) {
      if (!body[s] || !fits(s)) continue;
      body[s] = 0;
      carved[s] = 1;
      more = true;
      total -= volume[s];
      for (int k = 0; k <= D; ++k) {
        const Index v = simplices[s][static_cast<std::size_t>(k)];
        excess[at(v)] -= share[s][k];
        --count[at(v)];
      }
    }
  }
}

template <int D>
Index uncovered(const std::vector<Simplex<D>>& simplices, const std::vector<char>& body, std::size_t points) {
  std::vector<char> covered(points);
  for (std::size_t s = 0; s < simplices.size(); ++s)
    if (body[s])
      for (const Index v : simplices[s]) covered[at(v)] = 1;
  const auto none = std::find(covered.begin(), covered.end(), 0);
  return none == covered.end() ? no_particle : static_cast<Index>(none - covered.begin());
}

}  // namespace

template <int D>
double simplex_volume(const std::vector<Vec<D>>& X, const Simplex<D>& s) {
  constexpr double factorial = D == 3 ? 6 : D;
  return edges_of<D>(X, s).determinant() / factorial;
}

template <int D>
BodyMesh<D> body_mesh(const std::vector<Vec<D>>& X, const std::vector<double>& V) {
  if (X.size() < D + 1)
    throw InputError(fmt::format("{} point(s) do not enclose a body in {}D", X.size(), D));
  const std::vector<double> distance = distances<D>(X, V);
  if (!(*std::min_element(distance.begin(), distance.end()) > 0))
    throw InputError("points coincide: no body is to be found between them");

  const std::vector<Vec<D>> moved = in_general_position<D>(X, distance);
  const std::vector<Simplex<D>> all = delaunay<D>(moved);
  const auto neighbour = neighbours_of<D>(all);
  const double unit = *std::max_element(distance.begin(), distance.end());
  std::vector<double> radius(all.size()), width(all.size());
  for (std::size_t s = 0; s < all.size(); ++s) {
    const Mat<D> edges = edges_of<D>(moved, all[s]);
    Vec<D> centre = 0.5 * edges.colwise().squaredNorm().transpose();
    const bool solid = solve_small<D, 1>(edges.transpose(), centre);
    radius[s] = solid ? unit * centre.norm() : std::numeric_limits<double>::infinity();
    if (!std::isfinite(radius[s])) radius[s] = std::numeric_limits<double>::infinity();
  }
  const std::vector<double> spacing = local_spacing<D>(X, distance, all, radius);
  for (std::size_t s = 0; s < all.size(); ++s) {
    double wide = 0;
    for (const Index v : all[s]) wide = std::max(wide, spacing[at(v)]);
    width[s] = radius[s] / wide;
  }

  std::vector<char> body;
  Index alone = no_particle;
  // Cells that are all much longer than wide need more.
  for (double limit = widest; limit < 5; limit *= 1.4) {
    body = choose<D>(neighbour, width, limit);
    alone = uncovered<D>(all, body, X.size());
    if (alone == no_particle) break;
  }
  if (alone != no_particle)
    throw InputError(
        fmt::format("particle {} at {} lies on no part of the body: in {}D that takes neighbours on all "
                    "sides, no more than "
                    "a few of its spacings away, and not on one {}",
                    alone, describe<D>(X[at(alone)]), D,
                    D == 3   ? "plane"
                    : D == 2 ? "line"
                             : "point"));

  if (!V.empty()) carve<D>(X, V, all, neighbour, body);
  BodyMesh<D> mesh;
  Sets parts(X.size());
  for (std::size_t s = 0; s < all.size(); ++s) {
    if (!body[s]) continue;
    unsigned outer = 0;
    for (unsigned k = 0; k <= D; ++k) {
      parts.join(all[s][0], all[s][k]);
      const Index n = neighbour[s][k];
      if (n != no_particle && body[at(n)]) continue;
      outer |= 1u << k;
      BoundaryFace<D> face{{}, k % 2 ? -1.0 : 1.0};
      for (unsigned j = 0, m = 0; j <= D; ++j)
        if (j != k) face.vertex[m++] = all[s][j];
      mesh.boundary.push_back(face);
    }
    mesh.simplices.push_back(all[s]);
    mesh.outer.push_back(outer);
  }
  mesh.part.assign(X.size(), 0);
  std::vector<int> number(X.size(), -1);
  for (std::size_t i = 0; i < X.size(); ++i) {
    int& n = number[at(parts.find(static_cast<Index>(i)))];
    if (n < 0) n = mesh.parts++;
    mesh.part[i] = n;
  }
  return mesh;
}

#define TAUT_INSTANTIATE(D)                                                         \
  template double simplex_volume<D>(const std::vector<Vec<D>>&, const Simplex<D>&); \
  template BodyMesh<D> body_mesh<D>(const std::vector<Vec<D>>&, const std::vector<double>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
