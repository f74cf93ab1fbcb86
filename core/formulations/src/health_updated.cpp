#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <taut/formulations/health_sweeps.hpp>
#include <taut/operators/pair_passes.hpp>
#include <taut/particles/material_groups.hpp>

namespace taut {

template <int D>
void check_updated_operator(const Particles<D>& p, const PairList& pairs, const KernelTable& table,
                            Health& health) {
  Field force(static_cast<std::size_t>(p.n), D);
  const Columns<D> X(p.X);
  const double* volume = p.V.component(0);
  const Index slices = (p.n + lanes - 1) / lanes;
#pragma omp parallel for schedule(static) if (p.n > parallel_from)
  for (Index s = 0; s < slices; ++s) {
    const Index i = s * lanes;
    Pack Xi[D], sum[D];
    for (int d = 0; d < D; ++d) Xi[d] = load(X.c[d] + i), sum[d] = pack(0);
    for_slots(pairs, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
      Pack Xab[D], r2 = pack(0);
      for (int d = 0; d < D; ++d) {
        Xab[d] = at(X.c[d]) - Xi[d];
        r2 += Xab[d] * Xab[d];
      }
      const Pack weight = lanes_of(pairs.mask(k)) ? 2 * at(volume) * table.slope_over_r(r2) : pack(0);
      for (int d = 0; d < D; ++d) sum[d] -= weight * Xab[d];
    });
    for (int d = 0; d < D; ++d) store(force.component(d) + i, load(volume + i) * sum[d]);
  }
  const std::vector<std::uint8_t> surface = on_surface(p, pairs);
  // None of these forms closes, free bodies move rightly for all that: told, but no reason to be flagged.
  add_spurious_forces(p, surface, force, told_only, told_only, health);
  add_neighbourhoods(p, pairs, surface, health);
}

template <int D>
MotionSample updated_motion(const Particles<D>& p, const std::vector<std::array<Index, 2>>& touching,
                            const Field& rho) {
  MotionSample sample;
  const auto n = static_cast<std::size_t>(p.n);
  const auto X = [&](Index i) { return p.X.template vec<D>(static_cast<std::size_t>(i)); };
  const auto x = [&](Index i) { return Vec<D>(X(i) + p.u.template vec<D>(static_cast<std::size_t>(i))); };
  const auto apart = [&](const Vec<D>& from, const Vec<D>& to) { return p.mirror.nearest(to - from); };
  // F by least squares over what touched: these forms keep none.
  std::vector<Mat<D>> moment(n, Mat<D>::Zero()), F(n, Mat<D>::Zero());
  for (const auto& [a, b] : touching) {
    const Vec<D> X_ab = apart(X(a), X(b)), x_ab = apart(x(a), x(b));
    for (const Index i : {a, b}) {
      moment[static_cast<std::size_t>(i)] += X_ab * X_ab.transpose();
      F[static_cast<std::size_t>(i)] += x_ab * X_ab.transpose();
    }
  }
  const auto modulus = [&](std::size_t i) { return p.materials[p.material[i]]->parameters().E; };
  std::vector<bool> has(n, false);
  double squares = 0, weights = 0, density = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(moment[i].determinant() > 1e-3 * std::pow(p.dx, 2 * D))) continue;
    has[i] = true;
    F[i] = F[i] * moment[i].inverse();
    const double w = p.V.component(0)[i] * p.modelled_share(static_cast<Index>(i));
    const double J = F[i].determinant();
    const double from_density = p.materials[p.material[i]]->density() / rho.component(0)[i];
    density += w * (from_density / J - 1) * (from_density / J - 1);
    weights += w;
    sample.strain += w * modulus(i) * (0.5 * (F[i].transpose() * F[i] - Mat<D>::Identity())).squaredNorm();
  }
  std::vector<double> rough(n, 0.0);
  std::vector<int> count(n, 0);
  double widest = 0;
  for (const auto& [a, b] : touching) {
    const Vec<D> X_ab = apart(X(a), X(b)), x_ab = apart(x(a), x(b));
    for (const Index i : {a, b}) {
      const auto k = static_cast<std::size_t>(i);
      if (!has[k]) continue;
      const double relative = (x_ab - F[k] * X_ab).squaredNorm() / X_ab.squaredNorm();
      rough[k] += relative;
      ++count[k];
      if (relative > sample.worst) sample.worst = relative, sample.worst_at = i;
    }
    const double gap = x_ab.squaredNorm() / X_ab.squaredNorm();
    if (gap > widest) widest = gap, sample.gap_at = a;
  }
  for (std::size_t i = 0; i < n; ++i) {
    if (count[i] == 0) continue;
    const double w = p.V.component(0)[i] * p.modelled_share(static_cast<Index>(i));
    sample.rough += w * modulus(i) * rough[i] / count[i];
    squares += w * rough[i] / count[i];
  }
  if (!(weights > 0)) return sample;
  sample.known = true;
  sample.mean = std::sqrt(squares / weights);
  sample.worst = std::sqrt(sample.worst);
  sample.density = std::sqrt(density / weights);
  sample.gap = std::sqrt(widest);
  return sample;
}

#define TAUT_INSTANTIATE(D)                                                                              \
  template void check_updated_operator<D>(const Particles<D>&, const PairList&, const KernelTable&,      \
                                          Health&);                                                      \
  template MotionSample updated_motion<D>(const Particles<D>&, const std::vector<std::array<Index, 2>>&, \
                                          const Field&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
