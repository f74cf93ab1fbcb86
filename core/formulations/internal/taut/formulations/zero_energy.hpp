#pragma once
/// \file
/// Control of zero-energy modes for total Lagrangian forms by a penalty on pairs.

#include <algorithm>
#include <taut/base/parallel.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/pair_payload.hpp>
#include <taut/particles/particles.hpp>

namespace taut {

/// Penalty on the part of neighbours' motion that the gradients do not see, derived from the energy
///   1/4 sum_a sum_b k_ab |u_ab - H_a X_ab|^2,   k_ab = alpha E V_a V_b W_ab / |X_ab|^2,
/// u_ab - H_a X_ab = x_ab - F_a X_ab with H = F - I: displacements keep the digits of small ones.
/// The stiffness is that of Ganzenmueller (CMAME 286, 2015, eq. 19-21); his force is the first of the two
/// parts here, projected on the current pair vector, and is the derivative of no energy. The force on a is
///   sum_b k_ab (u_ab - 1/2 (H_a + H_b) X_ab)
/// and what the operator's adjoint makes of V_a P_a = -1/2 sum_b k_ab (u_ab - H_a X_ab) (x) X_ab beside the
/// material's stress. Without that part, which vanishes only where H is the least squares fit with weights k,
/// the control feeds motions on irregular clouds. Both momenta are kept as the operator keeps them. The
/// energy is quadratic in the displacements: its stiffness does not depend on the state.
template <int D>
class ZeroEnergyControl {
 public:
  ZeroEnergyControl(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h,
                    double alpha)
      : p_(p), pairs_(pairs), H_(static_cast<std::size_t>(p.total), D * D) {
    stiffness_ = AlignedArray<float>(static_cast<std::size_t>(pairs.slots()) * lanes);
    const double* V = p.V.component(0);
    parallel_for_dynamic(pairs.slices(), 64, true, [&](Index s) {
      for (Index a = s * lanes; a < std::min<Index>((s + 1) * lanes, p.total); ++a)
        pairs.for_each(a, [&](Index b, std::int64_t k, int lane) {
          const double r = (p.X.template vec<D>(a) - p.X.template vec<D>(b)).norm();
          // Products that do not tell a from b, to the last bit.
          const double E = 0.5 * (modulus(a) + modulus(b)), V2 = V[a] * V[b];
          stiffness_[static_cast<std::size_t>(k * lanes + lane)] =
              static_cast<float>(alpha * E * V2 * kernel.value(r, h * p.support_scale(a, b)) / (r * r));
        });
    });
  }

  /// Keeps the displacement gradients of a slice for what follows.
  TAUT_INLINE void keep(Index s, const Pack (&H)[D * D]) {
    for (int c = 0; c < D * D; ++c) store(H_.component(c) + s * lanes, H[c]);
  }
  Field& gradients() { return H_; }

  /// Adds V_a P_a M_a of the eight particles of a slice to Q.
  void add_stress(Index s, const Columns<D>& u, const SliceCoefficients<D>& of, Field& Q) const {
    Pack H[D * D], moment[D * D];
    for (int c = 0; c < D * D; ++c) {
      H[c] = load(H_.component(c) + s * lanes);
      moment[c] = pack(0);
    }
    for_residuals(s, u, H, [&](Pack k, const Pack(&X)[D], const Pack(&residual)[D]) TAUT_INLINE_LAMBDA {
      for (int d = 0; d < D; ++d) {
        const Pack along = k * residual[d];
        for (int e = 0; e < D; ++e) moment[d * D + e] += along * X[e];
      }
    });
    for (int d = 0; d < D; ++d)
      for (int e = 0; e < D; ++e) {
        double* to = Q.component(d * D + e) + s * lanes;
        store(to, load(to) - 0.5 * of.times_matrix(moment + d * D, e));
      }
  }

  /// Adds the forces along pairs of the eight particles of a slice. Needs H of its neighbours.
  void add_to(Index s, const Columns<D>& u, Pack (&force)[D]) const {
    const Columns<D> X(p_.X);
    const Columns<D * D> H(H_);
    const Index i = s * lanes;
    for_slots(pairs_, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
      const Pack stiffness = load(stiffness_.data() + k * lanes);
      Pack half[D];
      for (int e = 0; e < D; ++e) half[e] = 0.5 * (at(X.c[e]) - load(X.c[e] + i));
      for (int d = 0; d < D; ++d) {
        Pack residual = at(u.c[d]) - load(u.c[d] + i);
        for (int e = 0; e < D; ++e) residual -= (load(H.c[d * D + e] + i) + at(H.c[d * D + e])) * half[e];
        force[d] += stiffness * residual;
      }
    });
  }

  /// Energies [J] of the eight particles of a slice, whose displacement gradients are given.
  Pack energy(Index s, const Columns<D>& u, const Pack (&H)[D * D]) const {
    Pack sum = pack(0);
    for_residuals(s, u, H, [&](Pack k, const Pack(&)[D], const Pack(&residual)[D]) TAUT_INLINE_LAMBDA {
      for (int d = 0; d < D; ++d) sum += k * residual[d] * residual[d];
    });
    return 0.25 * sum;
  }

  std::size_t bytes() const { return H_.bytes() + stiffness_.bytes(); }

 private:
  // Calls f(k_ab, X_ab, u_ab - H_a X_ab) for each slot of a slice; k is zero in lanes without a pair.
  template <class Use>
  TAUT_INLINE void for_residuals(Index s, const Columns<D>& u, const Pack (&H)[D * D], Use&& f) const {
    const Columns<D> X(p_.X);
    const Index i = s * lanes;
    for_slots(pairs_, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
      Pack Xab[D], residual[D];
      for (int e = 0; e < D; ++e) Xab[e] = at(X.c[e]) - load(X.c[e] + i);
      for (int d = 0; d < D; ++d) {
        residual[d] = at(u.c[d]) - load(u.c[d] + i);
        for (int e = 0; e < D; ++e) residual[d] -= H[d * D + e] * Xab[e];
      }
      f(load(stiffness_.data() + k * lanes), Xab, residual);
    });
  }
  double modulus(Index a) const {
    const Index of = a < p_.n ? a : p_.mirror.master(a - p_.n);
    return p_.materials[p_.material[static_cast<std::size_t>(of)]]->parameters().E;
  }

  const Particles<D>& p_;
  const PairList& pairs_;
  Field H_;
  AlignedArray<float> stiffness_;
};

}  // namespace taut
