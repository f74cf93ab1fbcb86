#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <taut/base/disjoint_sets.hpp>
#include <taut/base/error.hpp>
#include <taut/formulations/assembly.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/particles/interfaces.hpp>
#include <taut/particles/pair_rule.hpp>

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
                      "xyz"[plane.axis], cloud.origin[plane.axis] + plane.at));
}

template <int D>
void tie_together(const std::vector<std::vector<Index>>& groups, Particles<D>& p) {
  if (groups.empty()) return;
  p.ties.begin.push_back(0);
  for (const auto& group : groups) {
    p.ties.particles.insert(p.ties.particles.end(), group.begin(), group.end());
    p.ties.begin.push_back(p.ties.particles.size());
  }
}

// Puts a twin for each part in the place of every particle, material by material, each in the order that
// there is: pairs never leave a material, so that its particles are best kept together.
template <int D>
void split(const Interfaces<D>& interfaces, const std::vector<std::uint8_t>& material, Particles<D>& p,
           std::vector<const MaterialPart<D>*>& parts) {
  std::vector<Index> ids;
  for (std::size_t m = 0; m < p.materials.size(); ++m)
    for (const Index id : p.id)
      for (const MaterialPart<D>& part : interfaces.parts(static_cast<std::size_t>(id)))
        if (part.material == m) {
          ids.push_back(id);
          parts.push_back(&part);
        }
  p.id = std::move(ids);
  p.n = static_cast<Index>(p.id.size());
  std::vector<std::vector<Index>> twins;
  std::vector<Index> group(p.place.size(), no_particle);
  std::vector<const MaterialPart<D>*> own(p.place.size(), nullptr);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto id = static_cast<std::size_t>(p.id[i]);
    if (interfaces.parts(id).size() > 1) {
      if (group[id] == no_particle) {
        group[id] = static_cast<Index>(twins.size());
        twins.emplace_back();
      }
      twins[static_cast<std::size_t>(group[id])].push_back(static_cast<Index>(i));
    }
    // The material that was set there or, where its cells lie elsewhere, the one that has most of it.
    const bool better = !own[id] || parts[i]->material == material[id] ||
                        (own[id]->material != material[id] && parts[i]->V > own[id]->V);
    if (!better) continue;
    own[id] = parts[i];
    p.place[id] = static_cast<Index>(i);
  }
  tie_together(twins, p);
}

// The body fits its period: it lies in it, and does not fill both of its ends.
template <int D>
void check_period(const Cloud<D>& cloud, const typename MirrorMap<D>::Period& period) {
  const double tolerance = on_plane * cloud.dx, origin = cloud.origin[period.axis];
  bool low = false, high = false;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double in = cloud.X[i][period.axis] - period.low;
    if (in < -tolerance || in > period.length + tolerance)
      throw InputError(
          fmt::format("the period from {:g} to {:g} along {} does not hold the body: particle {} "
                      "lies outside at {:g}",
                      origin + period.low, origin + period.low + period.length, "xyz"[period.axis], i,
                      origin + cloud.X[i][period.axis]));
    low = low || in <= tolerance;
    high = high || in >= period.length - tolerance;
  }
  if (low && high && cloud.cells.empty())
    throw InputError(fmt::format(
        "particles lie on both ends of the period from {:g} to {:g} along {}, which are one place: leave one "
        "end out, as cell-centred lattices do (Lattice::cell_centred), or use a formulation on cells",
        origin + period.low, origin + period.low + period.length, "xyz"[period.axis]));
}

// Ties the nodes at the ends of periods to those that they are the same as.
template <int D>
void tie_ends(const Cloud<D>& cloud, const std::vector<typename MirrorMap<D>::Period>& periods,
              Particles<D>& p) {
  if (periods.empty()) return;
  const double tolerance = on_plane * cloud.dx;
  DisjointSets sets(p.n);
  std::vector<std::uint8_t> tied(static_cast<std::size_t>(p.n), 0);
  for (const auto& period : periods) {
    const int along = D == 1 ? 0 : (period.axis + 1) % D;  // an axis to sort by
    std::vector<Index> low, high;
    for (Index i = 0; i < p.n; ++i) {
      const double in = p.X.component(period.axis)[i] - period.low;
      if (in <= tolerance) low.push_back(i);
      if (in >= period.length - tolerance) high.push_back(i);
    }
    const double* x = p.X.component(along);
    std::sort(low.begin(), low.end(), [&](Index a, Index b) { return x[a] < x[b]; });
    for (const Index i : high) {
      Vec<D> at = p.X.template vec<D>(i);
      at[period.axis] -= period.length;
      auto other = std::lower_bound(low.begin(), low.end(), at[along] - tolerance,
                                    [&](Index a, double value) { return x[a] < value; });
      while (other != low.end() && (p.X.template vec<D>(*other) - at).norm() > 2 * tolerance) ++other;
      if (other == low.end())
        throw InputError(
            fmt::format("particle {} on the end of the period along {} has no fellow on the other end",
                        p.id[static_cast<std::size_t>(i)], "xyz"[period.axis]));
      sets.join(i, *other);
      tied[static_cast<std::size_t>(i)] = tied[static_cast<std::size_t>(*other)] = 1;
    }
  }
  std::vector<std::vector<Index>> groups;
  const std::vector<Index> number = sets.numbers();
  std::vector<Index> group(static_cast<std::size_t>(p.n), no_particle);
  for (Index i = 0; i < p.n; ++i) {
    if (!tied[static_cast<std::size_t>(i)]) continue;
    Index& g = group[static_cast<std::size_t>(number[static_cast<std::size_t>(i)])];
    if (g == no_particle) {
      g = static_cast<Index>(groups.size());
      groups.emplace_back();
    }
    groups[static_cast<std::size_t>(g)].push_back(i);
  }
  tie_together(groups, p);
}

// More images than there are now that particles may have when they have moved.
template <int D>
Index room_for_images(const Particles<D>& p, double reach) {
  if (!p.mirror.possible()) return 0;
  const double layer = std::pow(static_cast<double>(p.n), (D - 1.0) / D) * (1 + std::ceil(reach / p.dx));
  return p.mirror.size() + static_cast<Index>(8 * layer) + 64;
}

}  // namespace

template <int D>
std::vector<double> multiplicity(const Cloud<D>& cloud,
                                 const std::vector<typename MirrorMap<D>::Plane>& planes) {
  std::vector<double> times(cloud.size(), 1.0);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    for (const auto& plane : planes)
      if (lies_on(plane, cloud.X[i], cloud.dx)) times[i] *= 2;
  return times;
}

template <int D>
Particles<D> assemble(const Cloud<D>& cloud, std::vector<std::shared_ptr<const Material<D>>> materials,
                      const std::vector<std::uint8_t>& material, const Surroundings<D>& around,
                      const Interfaces<D>* interfaces, bool twins) {
  const auto& planes = around.planes;
  const double reach = around.reach;
  std::size_t n = cloud.size();
  if (n == 0) throw InputError("the body has no particles");
  for (const auto& plane : planes)
    for (std::size_t i = 0; i < n; ++i) {
      const double beyond = (cloud.X[i][plane.axis] - plane.at) * (plane.side == 0 ? -1 : 1);
      if (beyond > on_plane * cloud.dx)
        throw InputError(fmt::format("the symmetry plane {} = {:g} cuts the body: particle {} lies beyond it",
                                     "xyz"[plane.axis], cloud.origin[plane.axis] + plane.at, i));
    }
  for (const auto& period : around.periods) check_period(cloud, period);

  Particles<D> p;
  p.n = static_cast<Index>(n);
  p.dx = cloud.dx;
  p.origin = cloud.origin;
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
  std::vector<const MaterialPart<D>*> parts;  // that particles are, if they are split
  if (twins) {
    split(*interfaces, material, p, parts);
    n = p.id.size();
  }
  std::vector<Vec<D>> ordered(n);
  for (std::size_t i = 0; i < n; ++i) ordered[i] = cloud.X[static_cast<std::size_t>(p.id[i])];
  // Cells need no images: their nodes at both ends of a period are tied.
  const auto periods = cloud.cells.empty() ? around.periods : std::vector<typename MirrorMap<D>::Period>{};
  if (!planes.empty() || !periods.empty())
    p.mirror = MirrorMap<D>(planes, periods, ordered, reach, on_plane * cloud.dx);
  p.total = p.n + p.mirror.size();

  const auto total = static_cast<std::size_t>(p.total + (around.follow ? room_for_images(p, reach) : 0));
  p.X = Field(total, D);
  p.u = p.v = p.a = p.m_flat = Field(total, D);
  p.V = p.m = Field(total, 1);
  // Padding stands far from everything: no loop over whole packs mistakes it for a neighbour.
  if (!cloud.spacing.empty()) p.spacing = Field(total, 1);
  std::fill(p.X.flat().begin(), p.X.flat().end(), 1e30 * cloud.dx);
  std::fill(p.m.flat().begin(), p.m.flat().end(), 1.0);
  const std::vector<double> times = multiplicity<D>(cloud, planes);
  p.material.resize(n);
  if (!planes.empty()) p.planes.resize(n);
  if (!cloud.B.empty()) p.B.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto id = static_cast<std::size_t>(p.id[i]);
    const MaterialPart<D>* part = parts.empty() ? nullptr : parts[i];
    const double V = (part ? part->V : cloud.V[id]) * times[id];
    if (!(V > 0) || !std::isfinite(V))
      throw InputError(fmt::format("particle {} has volume {:g}; it must be positive", id, V));
    p.X.template set_vec<D>(i, ordered[i]);
    p.V.component(0)[i] = V;
    if (!cloud.spacing.empty()) p.spacing.component(0)[i] = cloud.spacing[id];
    p.material[i] = part ? part->material : material[id];
    double mass = 0;
    if (interfaces && !part)
      for (const auto& share : interfaces->parts(id))
        mass += share.V * times[id] * p.materials[share.material]->density();
    else
      mass = V * p.materials[p.material[i]]->density();
    if (!std::isnormal(mass))
      throw InputError(fmt::format(
          "particle {} has mass {:g}: its volume {:g} times the density {:g} of \"{}\" is out of range", id,
          mass, V, p.materials[p.material[i]]->density(), p.materials[p.material[i]]->name()));
    p.m.component(0)[i] = mass;
    for (int d = 0; d < D; ++d) p.m_flat.component(d)[i] = p.m.component(0)[i];
    for (const auto& plane : planes)
      if (lies_on(plane, cloud.X[id], cloud.dx)) p.planes[i] |= static_cast<std::uint8_t>(1 << plane.axis);
    if (cloud.B.empty()) continue;
    // A plane is no boundary: across it the body goes on, and what lies on the plane counts both sides.
    const bool whole = !part || interfaces->parts(id).size() == 1;
    p.B[i] = (whole ? cloud.B[id] : part->B) * times[id];
    for (int d = 0; d < D; ++d)
      if (!planes.empty() && (p.planes[i] >> d & 1)) p.B[i][d] = 0;
  }
  if (!cloud.cells.empty()) {
    take_cells(cloud, planes, p);
    tie_ends(cloud, around.periods, p);
  }
  if (interfaces && interfaces->cells().size() == p.cells.size())
    p.cell_material = interfaces->cell_material();
  p.mirror.positions(p.X);
  p.mirror.scalars(p.V);
  if (!p.spacing.empty()) p.mirror.scalars(p.spacing);
  p.mirror.scalars(p.m);
  return p;
}

namespace {

// Whether a pair of the search is one. Coincident particles are no error of the search where some are tied.
template <int D>
bool counts(const Particles<D>& p, Index a, Index b) {
  if (!p.rule->counts(a, b)) return false;
  if (p.ties.empty()) return true;  // the search says it
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  if ((p.X.template vec<D>(i) - p.X.template vec<D>(j)).norm() > 1e-12 * p.dx) return true;
  const auto id = [&](Index k) {
    return p.id[static_cast<std::size_t>(k < p.n ? k : p.mirror.master(k - p.n))];
  };
  throw InputError(fmt::format(
      "particles {} and {} coincide: remove one of them, or move overlapping bodies apart", id(a), id(b)));
}

}  // namespace

template <int D>
PairList find_pairs_at_rest(const Particles<D>& p, const Method& method) {
  const SearchOptions options{search_method(method.neighbours), !p.ties.empty()};
  const auto points = points_of<D>(p.X, p.total);
  PairList pairs;
  if (p.spacing.empty()) {
    pairs = find_pairs<D>(points, method.support_dx * p.dx, options);
  } else {
    std::vector<double> radii(static_cast<std::size_t>(p.total));
    for (std::size_t i = 0; i < radii.size(); ++i) radii[i] = method.support_dx * p.spacing.component(0)[i];
    pairs = find_pairs<D>(points, radii, options);
  }
  if (p.rule) filter_pairs(pairs, [&](Index a, Index b) { return counts(p, a, b); });
  return pairs;
}

#define TAUT_INSTANTIATE(D)                                                                           \
  template std::vector<double> multiplicity<D>(const Cloud<D>&,                                       \
                                               const std::vector<typename MirrorMap<D>::Plane>&);     \
  template Particles<D> assemble<D>(const Cloud<D>&, std::vector<std::shared_ptr<const Material<D>>>, \
                                    const std::vector<std::uint8_t>&, const Surroundings<D>&,         \
                                    const Interfaces<D>*, bool);                                      \
  template PairList find_pairs_at_rest<D>(const Particles<D>&, const Method&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
