#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <taut/core/error.hpp>
#include <taut/internal/assembly.hpp>
#include <taut/neighbors/search.hpp>

namespace taut {

namespace {
// What lies on a symmetry plane, in spacings: round-off of a lattice, far below any jitter that is meant.
constexpr double on_plane = 1e-6;

template <class Plane, int D>
bool lies_on(const Plane& plane, const Vec<D>& X, double dx) {
  return std::abs(X[plane.axis] - plane.at) <= on_plane * dx;
}

// Whether the corners of each cell follow each other along the first axis.
template <int D>
bool in_rows(const Cloud<D>& cloud, const std::vector<Index>& place) {
  for (const auto& cell : cloud.cells)
    for (std::size_t c = 0; c < cell.size(); c += 2)
      if (place[static_cast<std::size_t>(cell[c + 1])] != place[static_cast<std::size_t>(cell[c])] + 1)
        return false;
  return true;
}

template <int D>
void take_cells(const Cloud<D>& cloud, const std::vector<typename MirrorMap<D>::Plane>& planes,
                Particles<D>& p) {
  p.cells = cloud.cells;
  p.cell_share = cloud.cell_share;
  for (auto& cell : p.cells)
    for (Index& corner : cell) corner = p.place[static_cast<std::size_t>(corner)];
  for (const auto& plane : planes)
    if (std::none_of(p.planes.begin(), p.planes.end(), [&](std::uint8_t on) { return on >> plane.axis & 1; }))
      throw InputError(
          fmt::format("no particle lies on the symmetry plane {} = {:g}, where the body's cells end",
                      "xyz"[plane.axis], plane.at));
}

}  // namespace

template <int D>
std::vector<double> multiplicity(const Cloud<D>& cloud, const std::vector<typename MirrorMap<D>::Plane>& planes) {
  std::vector<double> times(cloud.size(), 1.0);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (const auto& plane : planes)
      if (lies_on(plane, cloud.X[i], cloud.dx)) times[i] *= 2;
  return times;
}

template <int D>
Particles<D> assemble(const Cloud<D>& cloud, std::vector<std::shared_ptr<const Material<D>>> materials,
                      const std::vector<std::uint8_t>& material, const std::vector<typename MirrorMap<D>::Plane>& planes,
                      double reach) {
  const std::size_t n = cloud.size();
  if (n == 0) throw InputError("the body has no particles");
  for (const auto& plane : planes)
    for (std::size_t i = 0; i < n; ++i) {
      const double beyond = (cloud.X[i][plane.axis] - plane.at) * (plane.side == 0 ? -1 : 1);
      if (beyond > on_plane * cloud.dx)
        throw InputError(fmt::format("the symmetry plane {} = {:g} cuts the body: particle {} lies beyond it", "xyz"[plane.axis],
                                     plane.at, i));
    }

  Particles<D> p;
  p.n = static_cast<Index>(n);
  p.dx = cloud.dx;
  p.materials = std::move(materials);

  Field unordered(n, D);
  for (std::size_t i = 0; i < n; ++i) unordered.set_vec<D>(i, cloud.X[i]);
  p.id = locality_order<D>(points_of<D>(unordered, p.n), reach);
  p.place.resize(n);
  const auto set_places = [&] {
    for (std::size_t i = 0; i < n; ++i) p.place[static_cast<std::size_t>(p.id[i])] = static_cast<Index>(i);
  };
  set_places();
  // Sparse lattices are ordered along a curve; their makers put them in rows.
  if (!cloud.cells.empty() && !in_rows(cloud, p.place)) {
    std::iota(p.id.begin(), p.id.end(), Index{0});
    set_places();
  }
  std::vector<Vec<D>> ordered(n);
  for (std::size_t i = 0; i < n; ++i) ordered[i] = cloud.X[static_cast<std::size_t>(p.id[i])];
  if (!planes.empty()) p.mirror = MirrorMap<D>(planes, ordered, reach, on_plane * cloud.dx);
  p.total = p.n + p.mirror.size();

  const auto total = static_cast<std::size_t>(p.total);
  p.X = Field(total, D);
  p.v = p.a = p.m_flat = Field(total, D);
  p.V = p.m = Field(total, 1);
  // Padding stands far from everything: no loop over whole packs mistakes it for a neighbour.
  std::fill(p.X.flat().begin(), p.X.flat().end(), 1e30 * cloud.dx);
  std::fill(p.m.flat().begin(), p.m.flat().end(), 1.0);
  const std::vector<double> times = multiplicity<D>(cloud, planes);
  p.material.resize(n);
  if (!planes.empty()) p.planes.resize(n);
  if (!cloud.B.empty()) p.B.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto id = static_cast<std::size_t>(p.id[i]);
    const double V = cloud.V[id] * times[id];
    if (!(V > 0) || !std::isfinite(V)) throw InputError(fmt::format("particle {} has volume {:g}; it must be positive", id, V));
    p.X.template set_vec<D>(i, ordered[i]);
    p.V.component(0)[i] = V;
    p.material[i] = material[id];
    const double m = V * p.materials[material[id]]->density();
    if (!std::isnormal(m))
      throw InputError(fmt::format("particle {} has mass {:g}: its volume {:g} times the density {:g} of \"{}\" is out of range",
                                   id, m, V, p.materials[material[id]]->density(), p.materials[material[id]]->name()));
    p.m.component(0)[i] = m;
    for (int d = 0; d < D; ++d) p.m_flat.component(d)[i] = p.m.component(0)[i];
    for (const auto& plane : planes)
      if (lies_on(plane, cloud.X[id], cloud.dx)) p.planes[i] |= static_cast<std::uint8_t>(1 << plane.axis);
    if (cloud.B.empty()) continue;
    // A plane is no boundary: across it the body goes on, and what lies on the plane counts both sides.
    p.B[i] = cloud.B[id] * times[id];
    for (int d = 0; d < D; ++d)
      if (!planes.empty() && (p.planes[i] >> d & 1)) p.B[i][d] = 0;
  }
  if (!cloud.cells.empty()) take_cells(cloud, planes, p);
  p.mirror.positions(p.X);
  p.mirror.scalars(p.V);
  p.mirror.scalars(p.m);
  p.x = p.X;
  return p;
}

#define TAUT_INSTANTIATE(D)                                                                                           \
  template std::vector<double> multiplicity<D>(const Cloud<D>&, const std::vector<typename MirrorMap<D>::Plane>&); \
  template Particles<D> assemble<D>(const Cloud<D>&, std::vector<std::shared_ptr<const Material<D>>>,                 \
                                    const std::vector<std::uint8_t>&,                                                 \
                                    const std::vector<typename MirrorMap<D>::Plane>&, double);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
