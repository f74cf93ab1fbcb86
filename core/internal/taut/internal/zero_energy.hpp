#pragma once
/// \file
/// Pairwise control of zero-energy modes for total Lagrangian forms.

#include <cmath>
#include <taut/core/kernel.hpp>
#include <taut/core/particles.hpp>
#include <taut/internal/pair_passes.hpp>
#include <taut/neighbors/pair_list.hpp>

namespace taut {

/// Penalty on the part of a pair's motion that the gradients do not see (Ganzenmueller, CMAME 286, 2015, eq. 19–21):
///   f_a -= 1/2 alpha sum_b V_a V_b W_ab / |X_ab|^2 (E_a delta_ab + E_b delta_ba) x_ab / |x_ab|,
///   delta_ab = (F_a X_ab - x_ab) . x_ab / |x_ab|,
/// symmetrised as E (1/2 (F_a + F_b) X_ab - x_ab), along the current pair vector: both momenta are kept.
template <int D>
class ZeroEnergyControl {
 public:
  ZeroEnergyControl(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h, double alpha)
      : p_(p), pairs_(pairs), F_(static_cast<std::size_t>(p.total), D * D) {
    stiffness_ = AlignedArray<float>(static_cast<std::size_t>(pairs.slots()) * lanes);
    const double* V = p.V.component(0);
#pragma omp parallel for schedule(dynamic, 64)
    for (Index s = 0; s < pairs.slices(); ++s)
      for (Index a = s * lanes; a < std::min<Index>((s + 1) * lanes, p.total); ++a)
        pairs.for_each(a, [&](Index b, std::int64_t k, int lane) {
          const double r = (p.X.template vec<D>(a) - p.X.template vec<D>(b)).norm();
          const double E = 0.5 * (modulus(a) + modulus(b));
          stiffness_[static_cast<std::size_t>(k * lanes + lane)] =
              static_cast<float>(alpha * E * V[a] * V[b] * kernel.value(r, h) / (r * r));
        });
  }

  /// Keeps the deformation gradients of a slice for `add_to`.
  TAUT_INLINE void keep(Index s, const Pack (&F)[D * D]) {
    for (int c = 0; c < D * D; ++c) store(F_.component(c) + s * lanes, F[c]);
  }
  Field& deformation() { return F_; }

  /// Adds the control forces of the eight particles of a slice.
  void add_to(Index s, const Field& x, Pack (&force)[D]) const {
    const Columns<D> xs(x), Xs(p_.X);
    const Columns<D * D> Fs(F_);
    const Index i = s * lanes;
    for (std::int64_t k = pairs_.begin(s); k < pairs_.begin(s + 1); ++k) {
      Index at[lanes];
      for (int l = 0; l < lanes; ++l) at[l] = pairs_.is_contiguous(s, k) ? pairs_.first(k) + l : pairs_.block(k)[l];
      Pack X[D], xab[D], r2 = pack(0), along = pack(0);
      for (int d = 0; d < D; ++d) {
        X[d] = gather(Xs.c[d], at) - load(Xs.c[d] + i);
        xab[d] = gather(xs.c[d], at) - load(xs.c[d] + i);
        r2 += xab[d] * xab[d];
      }
      for (int d = 0; d < D; ++d) {
        Pack error = -xab[d];
        for (int e = 0; e < D; ++e)
          error += 0.5 * (load(Fs.c[d * D + e] + i) + gather(Fs.c[d * D + e], at)) * X[e];
        along += error * xab[d];
      }
      // Lanes without a pair have stiffness zero and may sit on themselves.
      const Pack factor = load(stiffness_.data() + k * lanes) * along / (r2 > 0 ? r2 : pack(1));
      for (int d = 0; d < D; ++d) force[d] -= factor * xab[d];
    }
  }

  /// Bound on the largest eigenvalue [1/s^2] that the control adds to M^-1 K (Gershgorin).
  double largest_eigenvalue(const PairList& pairs) const {
    double largest = 0;
    for (Index a = 0; a < p_.n; ++a) {
      double sum = 0;
      pairs.for_each(a, [&](Index, std::int64_t k, int lane) {
        sum += stiffness_[static_cast<std::size_t>(k * lanes + lane)];
      });
      largest = std::max(largest, 2 * sum / p_.m.component(0)[a]);
    }
    return largest;
  }

  std::size_t bytes() const { return F_.bytes() + stiffness_.bytes(); }

 private:
  double modulus(Index a) const {
    const Index of = a < p_.n ? a : p_.mirror.master(a - p_.n);
    return p_.materials[p_.material[static_cast<std::size_t>(of)]]->parameters().E;
  }

  const Particles<D>& p_;
  const PairList& pairs_;
  Field F_;
  AlignedArray<float> stiffness_;
};

}  // namespace taut
