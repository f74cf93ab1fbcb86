#include <algorithm>
#include <cmath>
#include <taut/base/parallel.hpp>
#include <taut/formulations/formulations.hpp>
#include <taut/formulations/power_iteration.hpp>
#include <taut/formulations/rest_stiffness.hpp>
#include <taut/formulations/total_lagrangian.hpp>

namespace taut {

namespace {

/// Total Lagrangian form whose stresses live on the bonds between neighbours (Breitzman & Dayal, J. Mech.
/// Phys. Solids 110, 2018; Chen, Mech. Res. Commun. 90, 2018). The deformation gradient of a bond is the mean
/// of its ends', put right along the bond, where the motion of its ends says it exactly:
///   H_ab = Hm + (u_ab - Hm X_ab) (x) X_ab / |X_ab|^2,   Hm = 1/2 (H_a + H_b),   F = I + H.
/// No motion of neighbours goes unseen, so there are no zero-energy modes, and no coefficient. The energy is
///   sum_a V_a / n_a sum_b psi_a(F_ab),   n_a the number of a's neighbours,
/// hence each volume counts once; forces are its exact derivative: with P_ab = (V_a / n_a P_a + V_b / n_b
/// P_b)(F_ab),
///   f_a = sum_b P_ab X_ab / |X_ab|^2 + what the operator's adjoint makes of
///   V_a P_a = 1/2 sum_b P_ab (I - X_ab (x) X_ab / |X_ab|^2).
/// All bonds of a particle weigh alike: kernels' weights leave those across a cell, at the edge of a support
/// of 1.5 dx, next to nothing to hold (jittered cantilever, dx 2 mm: errors 3 times as large with W for
/// `corrected`, 20 times for `compatible`). Both momenta are kept to round-off. The state that is reported of
/// a particle is that of its own F_a.
template <int D>
class TlBondAssociated final : public TotalLagrangian<D> {
  using Base = TotalLagrangian<D>;
  using Base::groups_;
  using Base::materials_;
  using Base::op_;
  using Base::p_;
  using Base::pairs_;
  using Base::Q_;
  static constexpr int slots = 8;  ///< that one material call sees
  static constexpr int chunk = slots * lanes;

 public:
  explicit TlBondAssociated(const FormulationSetup<D>& setup)
      : Base(setup), H_(static_cast<std::size_t>(p_.total), D * D) {
    share_volumes();
    this->frequency_ =
        highest_frequency<D>(materials_, [this](const LawsAtRest& laws) { return stiffest_mode(laws); });
  }

  void update_accelerations(double t) override {
    if (!p_.mirror.empty()) p_.mirror.vectors(p_.u);
    const Seen seen = accelerations(Columns<D>(p_.u), [this](std::size_t m, const StressBlock<D>& block) {
      materials_[m]->stress(block);
    });
    this->stretch_ = seen.bounds;
    if (seen.inverted < p_.n) this->fail_inverted(seen.inverted);
    this->finish_accelerations(t);
  }

  double strain_energy() const override;
  double rough_limit() const override { return D == 1 ? told_only : 0.3; }
  MotionSample motion() const override {
    // A bond to a stiff particle is stiff at both ends, so that next to an interface little strain is left to
    // be seen: a sixth of the energy that the other forms have there for twice their error (bench/HEALTH.md,
    // case 11).
    MotionSample sample = Base::motion();
    if (sample.interface > 0) sample.interface *= 6;
    return sample;
  }
  std::size_t bytes() const override { return Base::bytes() + H_.bytes() + share_.bytes(); }

 private:
  /// Up to eight slots of a slice, laid out for the materials.
  struct Bonds {
    std::int64_t first;
    int count;
    alignas(64) double F[D * D * chunk];
    alignas(64) double H_diagonal[D * chunk];
    Pack X[slots][D];
    Pack inverse[slots];  ///< 1 / |X|^2, zero in lanes without a pair
    Pack volume[slots];   ///< of the bonds whose stress is asked for
  };
  struct Seen {
    StretchBounds bounds;
    Index inverted;
  };

  // Zero where the volume is, whatever the value: laws may not take the bonds of other materials.
  TAUT_INLINE static Pack weighted(Pack volume, Pack value) { return volume != 0 ? volume * value : pack(0); }
  void share_volumes();
  template <class Payload>
  void gradient_pass(const Payload& payload, const Columns<D>& u);
  // Calls f(bonds) for all slots of slice s, some at a time.
  template <class Use>
  void for_bonds(Index s, const Columns<D>& u, const Columns<D * D>& H, Bonds& bonds, Use&& f) const;
  // The part of the bonds' volumes that is of material m, both ends' or the slice's own; false where all is
  // of other materials.
  bool volumes(Index s, std::size_t m, bool both, Bonds& bonds) const;
  template <class Stresses>
  Seen bond_pass(const Columns<D>& u, const Stresses& stresses);
  template <class Payload>
  void force_pass(const Payload& payload);
  template <class Stresses>
  Seen accelerations(const Columns<D>& u, const Stresses& stresses);
  double stiffest_mode(const LawsAtRest& laws);

  Field H_;      ///< F - I
  Field share_;  ///< for each material V_a / n_a of its particles, zero of others
};

template <int D>
void TlBondAssociated<D>::share_volumes() {
  share_ = Field(static_cast<std::size_t>(p_.total), static_cast<int>(materials_.size()));
#pragma omp parallel for schedule(static) if (p_.n > parallel_from)
  for (Index a = 0; a < p_.n; ++a) {
    Index neighbours = 0;
    pairs_.for_each(a, [&](Index, std::int64_t, int) { ++neighbours; });
    if (neighbours > 0)
      share_.component(p_.material[static_cast<std::size_t>(a)])[a] = p_.V.component(0)[a] / neighbours;
  }
  if (!p_.mirror.empty()) p_.mirror.scalars(share_);
}

template <int D>
template <class Payload>
void TlBondAssociated<D>::gradient_pass(const Payload& payload, const Columns<D>& u) {
#pragma omp parallel for schedule(static) if (p_.n > parallel_from)
  for (Index s = 0; s < groups_.slices(); ++s) {
    Pack H[D * D];
    prefetch_neighbours(pairs_, s, u, payload);
    gradient_of_slice<D>(s, pairs_, payload, u, {op_, s}, H);
    if ((s + 1) * lanes > p_.n) this->fill_padding(s, H);
    for (int c = 0; c < D * D; ++c) store(H_.component(c) + s * lanes, H[c]);
  }
}

template <int D>
template <class Use>
void TlBondAssociated<D>::for_bonds(Index s, const Columns<D>& u, const Columns<D * D>& H, Bonds& bonds,
                                    Use&& f) const {
  const Columns<D> X(p_.X);
  const Index i = s * lanes;
  bonds.first = pairs_.begin(s);
  bonds.count = 0;
  for_slots(pairs_, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
    const int j = bonds.count++;
    const PackMask pair = lanes_of(pairs_.mask(k));
    Pack Xab[D], mean[D * D], r2 = pack(0);
    for (int d = 0; d < D; ++d) {
      Xab[d] = at(X.c[d]) - load(X.c[d] + i);
      r2 += Xab[d] * Xab[d];
      bonds.X[j][d] = Xab[d];
    }
    const Pack inverse = pair ? 1 / r2 : pack(0);
    bonds.inverse[j] = inverse;
    // Lanes without a pair do as their particle does.
    for (int c = 0; c < D * D; ++c) {
      const Pack own = load(H.c[c] + i);
      mean[c] = pair ? 0.5 * (own + at(H.c[c])) : own;
    }
    for (int d = 0; d < D; ++d) {
      Pack off = at(u.c[d]) - load(u.c[d] + i);
      for (int e = 0; e < D; ++e) off -= mean[d * D + e] * Xab[e];
      off *= inverse;
      off = pair ? off : pack(0);
      for (int e = 0; e < D; ++e) mean[d * D + e] += off * Xab[e];
    }
    deform<D>(mean, chunk, bonds.F + j * lanes, bonds.H_diagonal + j * lanes);
    if (bonds.count == slots || k + 1 == pairs_.begin(s + 1)) {
      f(bonds);
      bonds.first = k + 1;
      bonds.count = 0;
    }
  });
}

template <int D>
bool TlBondAssociated<D>::volumes(Index s, std::size_t m, bool both, Bonds& bonds) const {
  const double* share = share_.component(static_cast<int>(m));
  const Pack own = load(share + s * lanes);
  PackMask some{};
  for (int j = 0; j < bonds.count; ++j) {
    const std::int64_t k = bonds.first + j;
    Pack of_ends = own;
    if (both)
      of_ends += pairs_.is_contiguous(s, k) ? load(share + pairs_.first(k)) : gather(share, pairs_.block(k));
    bonds.volume[j] = lanes_of(pairs_.mask(k)) ? of_ends : pack(0);
    some |= bonds.volume[j] != 0;
  }
  return any(some);
}

// Q_a of all particles, and the forces along bonds in place of the accelerations.
template <int D>
template <class Stresses>
auto TlBondAssociated<D>::bond_pass(const Columns<D>& u, const Stresses& stresses) -> Seen {
  const Columns<D * D> H(H_);
  struct Watch {
    StretchExtremes<D> extremes;
    Index inverted;
  };
  Watch seen{{}, p_.n};
  const auto of_slice = [&](Index s, Watch& mine) {
    const Index i = s * lanes;
    Pack force[D], moment[D * D];  // sum_b P_ab X_ab / |X_ab|^2, sum_b P_ab (I - X_ab (x) X_ab / |X_ab|^2)
    for (auto& c : force) c = pack(0);
    for (auto& c : moment) c = pack(0);
    Bonds all;
    prefetch_neighbours(pairs_, s, H);
    for_bonds(s, u, H, all, [&](Bonds& bonds) {
      PackMask bad{};
      for (int j = 0; j < bonds.count; ++j) {
        Pack f[D * D];
        for (int c = 0; c < D * D; ++c) f[c] = load(bonds.F + c * chunk + j * lanes);
        bad |= ~(mine.extremes.add(f) > 0);
      }
      for (int l = 0; l < lanes; ++l)
        if (bad[l]) mine.inverted = std::min(mine.inverted, std::min(i + l, p_.n - 1));
      alignas(64) double P[D * D * chunk];
      for (std::size_t m = 0; m < materials_.size(); ++m) {
        if (!volumes(s, m, true, bonds)) continue;
        stresses(m, StressBlock<D>{bonds.count * lanes, chunk, bonds.F, P, nullptr, bonds.H_diagonal});
        for (int j = 0; j < bonds.count; ++j)
          for (int d = 0; d < D; ++d) {
            Pack row[D], along = pack(0);
            for (int e = 0; e < D; ++e) {
              row[e] = weighted(bonds.volume[j], load(P + (d * D + e) * chunk + j * lanes));
              along += row[e] * bonds.X[j][e];
            }
            along *= bonds.inverse[j];
            force[d] += along;
            for (int e = 0; e < D; ++e) moment[d * D + e] += row[e] - along * bonds.X[j][e];
          }
      }
    });
    const SliceCoefficients<D> of(op_, s);
    for (int d = 0; d < D; ++d) {
      store(p_.a.component(d) + i, force[d]);
      for (int e = 0; e < D; ++e)
        store(Q_.component(d * D + e) + i, 0.5 * of.times_matrix(moment + d * D, e));
    }
  };
  parallel_for(groups_.slices(), p_.n > parallel_from, seen, of_slice, [&](const Watch& mine) {
    seen.extremes.merge(mine.extremes);
    seen.inverted = std::min(seen.inverted, mine.inverted);
  });
  return {seen.extremes.bounds(), seen.inverted};
}

template <int D>
template <class Payload>
void TlBondAssociated<D>::force_pass(const Payload& payload) {
  const Columns<D * D> Q(Q_);
#pragma omp parallel for schedule(static) if (p_.n > parallel_from)
  for (Index s = 0; s < groups_.slices(); ++s) {
    Pack force[D];
    prefetch_neighbours(pairs_, s, Q, payload);
    force_of_slice<D>(s, pairs_, payload, Q, {op_, s}, force);
    const Index i = s * lanes;
    const Pack per_mass = 1 / load(p_.m.component(0) + i);
    for (int d = 0; d < D; ++d) {
      double* a = p_.a.component(d) + i;
      Pack ad = (load(a) + force[d]) * per_mass;
      if (i + lanes > p_.n)
        for (int l = p_.n - i; l < lanes; ++l) ad[l] = 0;
      store(a, ad);
    }
  }
}

template <int D>
template <class Stresses>
auto TlBondAssociated<D>::accelerations(const Columns<D>& u, const Stresses& stresses) -> Seen {
  return with_payload<D>(op_, pairs_, p_.X, [&](const auto& payload) {
    gradient_pass(payload, u);
    if (!p_.mirror.empty()) p_.mirror.tensors(H_);
    const Seen seen = bond_pass(u, stresses);
    if (!p_.mirror.empty()) p_.mirror.tensors(Q_);
    force_pass(payload);
    return seen;
  });
}

template <int D>
double TlBondAssociated<D>::strain_energy() const {
  this->need_energies();
  const Columns<D> u(p_.u);
  Field gradients(static_cast<std::size_t>(p_.total), D * D);
  for (Index s = 0; s < groups_.slices(); ++s) {
    Pack H[D * D];
    this->gradient(s, p_.u, H);
    if ((s + 1) * lanes > p_.n) this->fill_padding(s, H);
    for (int c = 0; c < D * D; ++c) store(gradients.component(c) + s * lanes, H[c]);
  }
  if (!p_.mirror.empty()) p_.mirror.tensors(gradients);
  const Columns<D * D> H(gradients);
  std::vector<double> energy(static_cast<std::size_t>(groups_.slices()), 0.0);
  parallel_for(groups_.slices(), p_.n > parallel_from, [&](Index s) {
    Bonds all;
    for_bonds(s, u, H, all, [&](Bonds& bonds) {
      alignas(64) double P[D * D * chunk], e[chunk];
      for (std::size_t m = 0; m < materials_.size(); ++m) {
        if (!volumes(s, m, false, bonds)) continue;
        materials_[m]->stress({bonds.count * lanes, chunk, bonds.F, P, e, bonds.H_diagonal});
        for (int j = 0; j < bonds.count; ++j) {
          const Pack e_of_bond = weighted(bonds.volume[j], load(e + j * lanes));
          for (int l = 0; l < lanes && s * lanes + l < p_.n; ++l)
            energy[static_cast<std::size_t>(s)] += p_.modelled_share(s * lanes + l) * e_of_bond[l];
        }
      }
    });
  });
  double total = 0;
  for (const double e : energy) total += e;
  return total;
}

// Largest eigenvalue of M^-1 K of the body at rest.
template <int D>
double TlBondAssociated<D>::stiffest_mode(const LawsAtRest& laws) {
  const auto stresses = [&laws](std::size_t m, const StressBlock<D>& block) {
    // Of opposite sign, so that what is left in the accelerations is M^-1 K y.
    const auto& law = laws[m];
    const IsotropicStiffness<double> opposite{-law.trace, -law.gradient, -law.transpose};
    opposite.template stress<D>(block);
  };
  const double eigenvalue = largest_eigenvalue<D>(
      p_.n, p_.total, p_.m, p_.a,
      [&](Field& y) {
        p_.tie(y);
        if (!p_.mirror.empty()) p_.mirror.vectors(y);
        accelerations(Columns<D>(y), stresses);
        p_.tie(p_.a);
      },
      &this->stiffest_);
  std::fill(p_.a.flat().begin(), p_.a.flat().end(), 0.0);
  return eigenvalue;
}

}  // namespace

FormulationEntry tl_bond_associated_entry() {
  const FormulationTraits traits{.stress = StressAt::bonds, .materials = MaterialsMeet::in_twins};
  return {.name = "tl_bond_associated",
          .line =
              "a deformation gradient and a stress a bond: no zero-energy modes, no coefficient; good on "
              "lattices",
          .fails = "on irregular clouds it does not converge; the material is evaluated for every bond",
          .make = formulation_makers<TlBondAssociated>(),
          .traits = traits,
          .parameters = pair_parameters(traits)};
}

}  // namespace taut
