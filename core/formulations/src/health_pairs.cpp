#include <algorithm>
#include <cmath>
#include <taut/formulations/health_sweeps.hpp>
#include <taut/operators/pair_passes.hpp>
#include <taut/particles/material_groups.hpp>

namespace taut {

namespace {

/// Young's modulus of every particle, images included.
template <int D>
Field moduli(const Particles<D>& p) {
  Field E(static_cast<std::size_t>(p.total), 1);
  for (Index i = 0; i < p.n; ++i)
    E.component(0)[i] = p.materials[p.material[static_cast<std::size_t>(i)]]->parameters().E;
  p.mirror.scalars(E);
  return E;
}

/// How much more than in a soft body the same roughness costs where volume hardly changes: what locks is the
/// part of it that would change volume (nu 0.49 in plane strain: 2.6).
template <int D>
double locking(const Material<D>& material) {
  const double modulus = material.density() * material.wave_speed() * material.wave_speed();
  return 1 + 0.1 * std::max(0.0, modulus / material.parameters().E - 1);
}

/// Largest |sum_b X_ab (x) G_ab M_a^T - I| of a slice's particles: what the operator makes of any linear
/// field.
template <int D, class Payload>
Pack linear_field_error(Index s, const PairList& pairs, const Payload& payload, const Columns<D>& X,
                        const PairOperator<D>& op) {
  Pack F[D * D], squares = pack(0);
  gradient_of_slice<D>(s, pairs, payload, X, {op, s}, F);
  for (int d = 0; d < D; ++d)
    for (int e = 0; e < D; ++e) {
      const Pack off = F[d * D + e] - (d == e ? 1.0 : 0.0);
      squares += off * off;
    }
  return squares;
}

}  // namespace

template <int D>
void check_pair_operator(const Particles<D>& p, const PairList& pairs, const PairOperator<D>& op,
                         Health& health) {
  Field stress(static_cast<std::size_t>(p.total), D * D), force(static_cast<std::size_t>(p.total), D);
  Field error(static_cast<std::size_t>(p.n), 1);
  const Index slices = (p.n + lanes - 1) / lanes;
  const Columns<D> X(p.X);
  with_payload<D>(op, pairs, p.X, [&](const auto& payload) {
#pragma omp parallel for schedule(static) if (p.n > parallel_from)
    for (Index s = 0; s < slices; ++s) {
      store(error.component(0) + s * lanes, linear_field_error<D>(s, pairs, payload, X, op));
      const SliceCoefficients<D> of(op, s);
      const Pack V = load(p.V.component(0) + s * lanes);
      for (int c = 0; c < D * D; ++c) store(stress.component(c) + s * lanes, V * of.matrix(c));
    }
    p.mirror.tensors(stress);
    const Columns<D * D> Q(stress);
#pragma omp parallel for schedule(static) if (p.n > parallel_from)
    for (Index s = 0; s < slices; ++s) {
      Pack f[D];
      force_of_slice<D>(s, pairs, payload, Q, {op, s}, f);
      for (int d = 0; d < D; ++d) store(force.component(d) + s * lanes, f[d]);
    }
  });
  const auto worst =
      static_cast<Index>(std::max_element(error.component(0), error.component(0) + p.n) - error.component(0));
  health.measures.push_back(measure_at(p, "health_linear_field_error", std::sqrt(error.component(0)[worst]),
                                       1e-3, "largest error of the gradient of a linear field", worst));
  const std::vector<std::uint8_t> surface = on_surface(p, pairs);
  add_spurious_forces(p, surface, force, 0.05, 0.1, health);
  add_neighbourhoods(p, pairs, surface, health);
}

template <int D>
MotionSample pair_motion(const Particles<D>& p, const PairList& pairs, const PairOperator<D>& op) {
  struct Sums {
    double rough = 0, strain = 0, interface = 0, squares = 0, volume = 0, worst = 0;
    Index worst_at = no_particle;
  };
  const Field moduli_of = moduli(p);
  const double* E = moduli_of.component(0);
  std::vector<double> locks;
  for (const auto& material : p.materials) locks.push_back(locking(*material));
  const Columns<D> u(p.u), X(p.X);
  const Index slices = (p.n + lanes - 1) / lanes;
  std::vector<Sums> sums(static_cast<std::size_t>(slices));
  with_payload<D>(op, pairs, p.X, [&](const auto& payload) {
#pragma omp parallel for schedule(static) if (p.n > parallel_from)
    for (Index s = 0; s < slices; ++s) {
      const Index i = s * lanes;
      Pack H[D * D], Xi[D], ui[D];
      gradient_of_slice<D>(s, pairs, payload, u, {op, s}, H);
      for (int d = 0; d < D; ++d) Xi[d] = load(X.c[d] + i), ui[d] = load(u.c[d] + i);
      const Pack Ei = load(E + i);
      Pack rough = pack(0), squares = pack(0), count = pack(0), worst = pack(0), contrast = pack(0);
      for_slots(pairs, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
        const PackMask pair = lanes_of(pairs.mask(k));
        Pack Xab[D], r2 = pack(0), R2 = pack(0);
        for (int d = 0; d < D; ++d) {
          Xab[d] = at(X.c[d]) - Xi[d];
          R2 += Xab[d] * Xab[d];
        }
        for (int d = 0; d < D; ++d) {
          Pack residual = at(u.c[d]) - ui[d];
          for (int e = 0; e < D; ++e) residual -= H[d * D + e] * Xab[e];
          r2 += residual * residual;
        }
        const Pack relative = pair ? r2 / R2 : pack(0);
        // Across an interface the softer side gives way: moduli in series.
        const Pack Eb = at(E), series = pair ? 2 * Ei * Eb / (Ei + Eb) : pack(0);
        rough += series * relative;
        const Pack step = Eb > Ei ? Eb - Ei : Ei - Eb, jump = pair ? step / (Ei + Eb) : pack(0);
        contrast = jump > contrast ? jump : contrast;
        squares += relative;
        count += pair ? pack(1) : pack(0);
        worst = relative > worst ? relative : worst;
      });
      Pack strain = pack(0);
      for (int d = 0; d < D; ++d)
        for (int e = 0; e < D; ++e) {
          Pack G = H[d * D + e] + H[e * D + d];  // twice Green's strain
          for (int k = 0; k < D; ++k) G += H[k * D + d] * H[k * D + e];
          strain += 0.25 * G * G;
        }
      Sums& sum = sums[static_cast<std::size_t>(s)];
      for (int l = 0; l < std::min<Index>(lanes, p.n - i); ++l) {
        if (!(count[l] > 0)) continue;
        const double V = p.V.component(0)[i + l] * p.modelled_share(i + l);
        sum.rough += V * locks[p.material[static_cast<std::size_t>(i + l)]] * rough[l] / count[l];
        sum.strain += V * Ei[l] * strain[l];
        sum.interface += V * Ei[l] * strain[l] * contrast[l];
        sum.squares += V * squares[l] / count[l];
        sum.volume += V;
        if (worst[l] > sum.worst) sum.worst = worst[l], sum.worst_at = i + l;
      }
    }
  });
  Sums all;
  for (const Sums& sum : sums) {
    all.rough += sum.rough;
    all.strain += sum.strain;
    all.interface += sum.interface;
    all.squares += sum.squares;
    all.volume += sum.volume;
    if (sum.worst > all.worst) all.worst = sum.worst, all.worst_at = sum.worst_at;
  }
  MotionSample sample;
  sample.known = true;
  sample.rough = all.rough;
  sample.strain = all.strain;
  sample.interface = p.materials.size() > 1 ? all.interface : -1;
  sample.worst = std::sqrt(all.worst);
  sample.worst_at = all.worst_at;
  sample.mean = all.volume > 0 ? std::sqrt(all.squares / all.volume) : 0;
  return sample;
}

#define TAUT_INSTANTIATE(D)                                                                          \
  template void check_pair_operator<D>(const Particles<D>&, const PairList&, const PairOperator<D>&, \
                                       Health&);                                                     \
  template MotionSample pair_motion<D>(const Particles<D>&, const PairList&, const PairOperator<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
