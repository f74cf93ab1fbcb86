#include <algorithm>
#include <cmath>
#include <optional>
#include <taut/base/parallel.hpp>
#include <taut/formulations/formulations.hpp>
#include <taut/formulations/power_iteration.hpp>
#include <taut/formulations/rest_stiffness.hpp>
#include <taut/formulations/total_lagrangian.hpp>
#include <taut/formulations/zero_energy.hpp>
#include <taut/operators/registry.hpp>

namespace taut {

namespace {

/// Displacement-based total Lagrangian form (thesis, University of Cape Town, ch. 5; Tran-Duc et al.
/// 2023, 2.3): F from displacements, P from the material, forces by the adjoint of the gradient.
template <int D>
class TlDisplacement final : public TotalLagrangian<D> {
  using Base = TotalLagrangian<D>;
  using Base::groups_;
  using Base::materials_;
  using Base::op_;
  using Base::p_;
  using Base::pairs_;
  using Base::Q_;
  static constexpr int chunk = chunk_particles;

 public:
  explicit TlDisplacement(const FormulationSetup<D>& setup) : Base(setup) {
    if (const double control = setup.method.zero_energy_control.value_or(0); control > 0)
      control_.emplace(p_, pairs_, this->kernel_, this->h_, control);
    this->frequency_ =
        highest_frequency<D>(materials_, [this](const LawsAtRest& laws) { return stiffest_mode(laws); });
  }

  void update_accelerations(double) override;
  double strain_energy() const override;
  double rough_limit() const override {
    // In 1D odd and even particles move by themselves, a part of dx out of step behind an interface, to no
    // harm.
    if (D == 1) return told_only;
    // Curvature parts a pair from its gradient in proportion to its length.
    const double wide = this->method_.support_dx / 1.5;
    return wide * wide * (control_ ? 0.15 : operator_traits(this->method_.operators).rough_limit);
  }
  std::size_t bytes() const override { return Base::bytes() + (control_ ? control_->bytes() : 0); }

 private:
  Index first_inverted(Index first, Index last, const double* F) const;
  // What the force pass reads of neighbours.
  void mirror_tensors() {
    if (p_.mirror.empty()) return;
    p_.mirror.tensors(Q_);
    if (control_) p_.mirror.tensors(control_->gradients());
  }
  template <class Payload>
  void gradient_pass(const Payload& payload);
  template <class Payload>
  void force_pass(const Payload& payload);
  double stiffest_mode(const LawsAtRest& laws);

  std::optional<ZeroEnergyControl<D>> control_;
};

template <int D>
template <class Payload>
void TlDisplacement<D>::gradient_pass(const Payload& payload) {
  const Columns<D> u(p_.u);
  const double* V = p_.V.component(0);
  double* Q[D * D];
  for (int c = 0; c < D * D; ++c) Q[c] = Q_.component(c);
  struct Seen {
    StretchExtremes<D> extremes;
    Index inverted;
  };
  Seen seen{{}, p_.n};
  const auto of_chunk = [&](Index c, Seen& mine) {
    alignas(64) double F[D * D * chunk], H_diagonal[D * chunk];
    const Index first = groups_.first_slice(c), last = groups_.last_slice(c);
    PackMask bad{};
    for (Index s = first; s < last; ++s) {
      Pack f[D * D];
      prefetch_neighbours(pairs_, s, u, payload);
      gradient_of_slice<D>(s, pairs_, payload, u, {op_, s}, f);
      if ((s + 1) * lanes > p_.n) this->fill_padding(s, f);
      if (control_) control_->keep(s, f);
      const Index at = (s - first) * lanes;
      deform<D>(f, chunk, F + at, H_diagonal + at);
      bad |= ~(mine.extremes.add(f) > 0);
    }
    if (any(bad)) mine.inverted = std::min(mine.inverted, first_inverted(first, last, F));
    alignas(64) double P_of_chunk[D * D * chunk];
    const int n = (last - first) * lanes;
    groups_.template call<D * D>(c, P_of_chunk, [&](std::size_t m, double* P) {
      materials_[m]->stress({n, chunk, F, P, nullptr, H_diagonal});
    });
    for (Index s = first; s < last; ++s) {
      const Index i = s * lanes;
      const double* P = P_of_chunk + (s - first) * lanes;
      const SliceCoefficients<D> of(op_, s);
      const Pack Vi = load(V + i);
      for (int d = 0; d < D; ++d) {
        Pack row[D];
        for (int j = 0; j < D; ++j) row[j] = load(P + (d * D + j) * chunk);
        for (int e = 0; e < D; ++e) store(Q[d * D + e] + i, of.times_matrix(row, e) * Vi);
      }
      if (control_) control_->add_stress(s, u, of, Q_);
    }
  };
  parallel_for(groups_.chunks(), p_.n > parallel_from, seen, of_chunk, [&](const Seen& mine) {
    seen.extremes.merge(mine.extremes);
    seen.inverted = std::min(seen.inverted, mine.inverted);
  });
  this->stretch_ = seen.extremes.bounds();
  if (seen.inverted < p_.n) this->fail_inverted(seen.inverted);
}

// The first particle of a chunk whose J is not positive, or n.
template <int D>
Index TlDisplacement<D>::first_inverted(Index first, Index last, const double* F) const {
  for (Index s = first; s < last; ++s) {
    Pack f[D * D];
    for (int k = 0; k < D * D; ++k) f[k] = load(F + k * chunk + (s - first) * lanes);
    const Pack J = StretchExtremes<D>().add(f);
    for (int l = 0; l < lanes; ++l)
      if (!(J[l] > 0)) return s * lanes + l;
  }
  return p_.n;
}

template <int D>
template <class Payload>
void TlDisplacement<D>::force_pass(const Payload& payload) {
  const Columns<D> u(p_.u);
  const Columns<D * D> Q(Q_);
  const double* m = p_.m.component(0);
  double* a[D];
  for (int d = 0; d < D; ++d) a[d] = p_.a.component(d);
#pragma omp parallel for schedule(static) if (p_.n > parallel_from)
  for (Index s = 0; s < groups_.slices(); ++s) {
    Pack force[D];
    prefetch_neighbours(pairs_, s, Q, payload);
    force_of_slice<D>(s, pairs_, payload, Q, {op_, s}, force);
    if (control_) control_->add_to(s, u, force);
    const Index i = s * lanes;
    const Pack per_mass = 1 / load(m + i);
    for (int d = 0; d < D; ++d) {
      Pack ad = force[d] * per_mass;
      if (i + lanes > p_.n)
        for (int l = p_.n - i; l < lanes; ++l) ad[l] = 0;
      store(a[d] + i, ad);
    }
  }
}

template <int D>
void TlDisplacement<D>::update_accelerations(double t) {
  if (!p_.mirror.empty()) p_.mirror.vectors(p_.u);
  with_payload<D>(op_, pairs_, p_.X, [&](const auto& payload) {
    gradient_pass(payload);
    mirror_tensors();
    force_pass(payload);
  });
  this->finish_accelerations(t);
}

template <int D>
double TlDisplacement<D>::strain_energy() const {
  this->need_energies();
  std::vector<double> energy(static_cast<std::size_t>(groups_.chunks()), 0.0);
  parallel_for(groups_.chunks(), p_.n > parallel_from, [&](Index c) {
    alignas(64) double F[D * D * chunk], H_diagonal[D * chunk], P[D * D * chunk], e[chunk];
    const Index first = groups_.first_slice(c), last = groups_.last_slice(c);
    alignas(64) double of_control[chunk] = {};
    for (Index s = first; s < last; ++s) {
      Pack f[D * D];
      const Index at = (s - first) * lanes;
      this->gradient(s, p_.u, f);
      if (control_) store(of_control + at, control_->energy(s, Columns<D>(p_.u), f));
      deform<D>(f, chunk, F + at, H_diagonal + at);
    }
    const int n = (last - first) * lanes;
    groups_.template call<1>(c, e, [&](std::size_t m, double* out) {
      materials_[m]->stress({n, chunk, F, P, out, H_diagonal});
    });
    for (Index i = first * lanes; i < std::min<Index>(last * lanes, p_.n); ++i)
      energy[static_cast<std::size_t>(c)] +=
          p_.modelled_share(i) *
          (p_.V.component(0)[i] * e[i - first * lanes] + of_control[i - first * lanes]);
  });
  double total = 0;
  for (const double e : energy) total += e;
  return total;
}

// Largest eigenvalue of M^-1 K of the body at rest. The control's own stiffness, which does not depend on the
// state, is in it.
template <int D>
double TlDisplacement<D>::stiffest_mode(const LawsAtRest& laws) {
  Field stiffness(static_cast<std::size_t>(p_.total), 3);  // times V; zero in the padding
  for (Index i = 0; i < p_.n; ++i) {
    const auto& law = laws[p_.material[static_cast<std::size_t>(i)]];
    const double V = p_.V.component(0)[i];
    stiffness.component(0)[i] = V * law.trace;
    stiffness.component(1)[i] = V * law.gradient;
    stiffness.component(2)[i] = V * law.transpose;
  }
  const Columns<D * D> Q(Q_);
  const double* m = p_.m.component(0);
  const auto apply = [&](Field& y) {
    p_.tie(y);
    if (!p_.mirror.empty()) p_.mirror.vectors(y);
    const Columns<D> yc(y);
    with_payload<D>(op_, pairs_, p_.X, [&](const auto& payload) {
#pragma omp parallel for schedule(static) if (p_.n > parallel_from)
      for (Index s = 0; s < groups_.slices(); ++s) {
        const SliceCoefficients<D> of(op_, s);
        Pack H[D * D], P[D * D];
        gradient_of_slice<D>(s, pairs_, payload, yc, of, H);
        const IsotropicStiffness<Pack> law{load(stiffness.component(0) + s * lanes),
                                           load(stiffness.component(1) + s * lanes),
                                           load(stiffness.component(2) + s * lanes)};
        law.template stress<D>(H, P);
        for (int d = 0; d < D; ++d)
          for (int e = 0; e < D; ++e)
            store(Q_.component(d * D + e) + s * lanes, of.times_matrix(P + d * D, e));
        if (control_) {
          control_->keep(s, H);
          control_->add_stress(s, yc, of, Q_);
        }
      }
      mirror_tensors();
#pragma omp parallel for schedule(static) if (p_.n > parallel_from)
      for (Index s = 0; s < groups_.slices(); ++s) {
        Pack force[D];
        force_of_slice<D>(s, pairs_, payload, Q, {op_, s}, force);
        if (control_) control_->add_to(s, yc, force);
        const Pack mass = load(m + s * lanes);
        for (int d = 0; d < D; ++d) store(p_.a.component(d) + s * lanes, -force[d] / mass);
      }
    });
    p_.tie(p_.a);
  };
  const double eigenvalue = largest_eigenvalue<D>(p_.n, p_.total, p_.m, p_.a, apply, &this->stiffest_);
  std::fill(p_.a.flat().begin(), p_.a.flat().end(), 0.0);
  return eigenvalue;
}

}  // namespace

FormulationEntry tl_displacement_entry() {
  const FormulationTraits traits{.materials = MaterialsMeet::in_twins};
  std::vector<Parameter> parameters = pair_parameters(traits);
  parameters.push_back(
      number_parameter("zero_energy_control", traits.zero_energy_control, Interval::non_negative(), "",
                       "coefficient of the penalty on what neighbours do and gradients do not "
                       "see; stiffens where large; 0 = absent"));
  return {
      .name = "tl_displacement",
      .line =
          "total Lagrangian, displacements; F = Σ x ⊗ g, forces by the exact adjoint; optional zero-energy "
          "control, derived from an energy",
      .fails = "with `corrected` operators on irregular clouds (use `antisymmetric` or `compatible`)",
      .make = formulation_makers<TlDisplacement>(),
      .traits = traits,
      .parameters = std::move(parameters)};
}

}  // namespace taut
