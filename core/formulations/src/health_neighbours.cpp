#include <algorithm>
#include <array>
#include <cmath>
#include <taut/formulations/health_sweeps.hpp>
#include <taut/operators/pair_passes.hpp>
#include <taut/particles/material_groups.hpp>

namespace taut {

template <int D>
std::vector<std::uint8_t> on_surface(const Particles<D>& p, const PairList& pairs) {
  constexpr double lopsided = 0.3;
  const Index slices = (p.n + lanes - 1) / lanes;
  std::vector<std::uint8_t> surface(static_cast<std::size_t>(slices) * lanes, 0);
  const Columns<D> X(p.X);
#pragma omp parallel for schedule(static) if (p.n > parallel_from)
  for (Index s = 0; s < slices; ++s) {
    const Index i = s * lanes;
    if (!p.B.empty()) {
      for (Index a = i; a < std::min(p.n, i + lanes); ++a)
        surface[static_cast<std::size_t>(a)] = !p.B[static_cast<std::size_t>(a)].isZero();
      continue;
    }
    Pack Xi[D], sum[D], squares = pack(0), count = pack(0), length = pack(0);
    for (int d = 0; d < D; ++d) Xi[d] = load(X.c[d] + i), sum[d] = pack(0);
    for_slots(pairs, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
      const PackMask pair = lanes_of(pairs.mask(k));
      for (int d = 0; d < D; ++d) {
        const Pack Xab = pair ? at(X.c[d]) - Xi[d] : pack(0);
        sum[d] += Xab;
        squares += Xab * Xab;
      }
      count += pair ? pack(1) : pack(0);
    });
    for (int d = 0; d < D; ++d) length += sum[d] * sum[d];
    for (int l = 0; l < lanes; ++l)
      surface[static_cast<std::size_t>(i + l)] =
          !(count[l] > 0) || length[l] > lopsided * lopsided * squares[l] * count[l];
  }
  surface.resize(static_cast<std::size_t>(p.n));
  return surface;
}

namespace {

/// Layers of particles from the surface to the middle of the body, where it is thinnest, and a particle
/// there.
template <int D>
std::pair<int, Index> thinnest(const Particles<D>& p, const PairList& pairs,
                               const std::vector<std::uint8_t>& surface) {
  constexpr int deep = 4;  // further in, a body is thick
  std::vector<int> depth(surface.size(), deep);
  std::vector<Index> order;
  for (Index a = 0; a < p.n; ++a)
    if (surface[static_cast<std::size_t>(a)]) depth[static_cast<std::size_t>(a)] = 0, order.push_back(a);
  const auto own = [&](Index b) { return b < p.n ? b : p.mirror.master(b - p.n); };
  for (std::size_t k = 0; k < order.size(); ++k)
    pairs.for_each(order[k], [&](Index b, std::int64_t, int) {
      int& of = depth[static_cast<std::size_t>(own(b))];
      if (of < deep || depth[static_cast<std::size_t>(order[k])] + 1 == deep) return;
      of = depth[static_cast<std::size_t>(order[k])] + 1;
      order.push_back(own(b));
    });
  // From the deepest outwards: how deep the body gets inwards of a particle.
  std::vector<int> reach = depth;
  for (std::size_t k = order.size(); k-- > 0;) {
    int& of = reach[static_cast<std::size_t>(order[k])];
    pairs.for_each(order[k], [&](Index b, std::int64_t, int) {
      const auto j = static_cast<std::size_t>(own(b));
      if (depth[j] > depth[static_cast<std::size_t>(order[k])]) of = std::max(of, reach[j]);
    });
  }
  int least = deep + 1;
  Index at = no_particle;
  for (const Index a : order)
    if (reach[static_cast<std::size_t>(a)] < least) least = reach[static_cast<std::size_t>(at = a)];
  return {least, at};
}

}  // namespace

template <int D>
HealthMeasure measure_at(const Particles<D>& p, std::string name, double value, double limit,
                         std::string meaning, Index at) {
  HealthMeasure m{std::move(name), value, limit, false, std::move(meaning), -1, {}};
  if (at < 0 || at >= p.n) return m;
  m.particle = p.id[static_cast<std::size_t>(at)];
  for (int d = 0; d < D; ++d) m.X[static_cast<std::size_t>(d)] = p.X.component(d)[at];
  return m;
}

template <int D>
void add_spurious_forces(const Particles<D>& p, const std::vector<std::uint8_t>& surface, const Field& force,
                         double limit_inside, double limit_faces, Health& health) {
  const double face = std::pow(p.dx, D - 1);
  double inside = 0, faces = 0, areas = 0, worst = -1, worst_face = -1;
  std::int64_t count = 0;
  Index at = no_particle, at_face = no_particle;
  for (Index a = 0; a < p.n; ++a) {
    const auto i = static_cast<std::size_t>(a);
    if (surface[i]) {
      if (p.B.empty()) continue;
      const double off = (force.template vec<D>(i) + p.B[i]).squaredNorm();
      faces += off;
      areas += p.B[i].squaredNorm();
      if (off > worst_face) worst_face = off, at_face = a;
    } else {
      const double off = force.template vec<D>(i).squaredNorm() / (face * face);
      inside += off;
      ++count;
      if (off > worst) worst = off, at = a;
    }
  }
  if (count > 0)
    health.measures.push_back(
        measure_at(p, "health_spurious_force", std::sqrt(inside / static_cast<double>(count)), limit_inside,
                   "force of a constant stress inside the body, over that on a cell's face (rms)", at));
  if (areas > 0)
    health.measures.push_back(
        measure_at(p, "health_spurious_face_force", std::sqrt(faces / areas), limit_faces,
                   "what a constant stress leaves of its tractions on the faces, over these (rms)", at_face));
}

template <int D>
void add_neighbourhoods(const Particles<D>& p, const PairList& pairs,
                        const std::vector<std::uint8_t>& surface, Health& health) {
  Index fewest = std::numeric_limits<Index>::max(), at = no_particle;
  for (Index s = 0; s * lanes < p.n; ++s) {
    std::array<Index, lanes> count{};
    for (std::int64_t k = pairs.begin(s); k < pairs.begin(s + 1); ++k)
      for (int l = 0; l < lanes; ++l) count[static_cast<std::size_t>(l)] += pairs.mask(k) >> l & 1;
    for (Index a = s * lanes; a < std::min(p.n, (s + 1) * lanes); ++a)
      if (const Index of = count[static_cast<std::size_t>(a % lanes)]; of < fewest) fewest = of, at = a;
  }
  HealthMeasure few =
      measure_at(p, "health_fewest_neighbours", fewest, D, "neighbours of the particle with the fewest", at);
  few.from_below = true;
  health.measures.push_back(std::move(few));
  if (D == 1) return;
  const auto [layers, where] = thinnest(p, pairs, surface);
  if (where < 0) return;
  HealthMeasure thin =
      measure_at(p, "health_thickness", 2 * layers + 1, -told_only,
                 "particles across the body where it is thinnest, to one; 9: that or more", where);
  thin.from_below = true;
  health.measures.push_back(std::move(thin));
}

#define TAUT_INSTANTIATE(D)                                                                                 \
  template HealthMeasure measure_at<D>(const Particles<D>&, std::string, double, double, std::string,       \
                                       Index);                                                              \
  template std::vector<std::uint8_t> on_surface<D>(const Particles<D>&, const PairList&);                   \
  template void add_spurious_forces<D>(const Particles<D>&, const std::vector<std::uint8_t>&, const Field&, \
                                       double, double, Health&);                                            \
  template void add_neighbourhoods<D>(const Particles<D>&, const PairList&,                                 \
                                      const std::vector<std::uint8_t>&, Health&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
