#pragma once
/// \file
/// What the total Lagrangian forms on pairs have in common.

#include <Eigen/LU>
#include <array>
#include <taut/base/disjoint_sets.hpp>
#include <taut/formulations/assembly.hpp>
#include <taut/formulations/health_sweeps.hpp>
#include <taut/formulations/hyperelastic_form.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/operators/operators.hpp>
#include <taut/operators/pair_passes.hpp>
#include <taut/particles/material_groups.hpp>
#include <taut/particles/pair_rule.hpp>

namespace taut {

/// Pairs and their operator, and the state of a particle that follows from its deformation gradient.
template <int D>
class TotalLagrangian : public HyperelasticForm<D> {
 protected:
  using Formulation<D>::p_;
  using HyperelasticForm<D>::materials_;

 public:
  explicit TotalLagrangian(const FormulationSetup<D>& setup)
      : HyperelasticForm<D>(setup),
        groups_(p_),
        kernel_(setup.method.kernel, D),
        h_(setup.method.support_dx * p_.dx / kernel_.radius_factor()) {
    pairs_ = find_pairs_at_rest(p_, setup.method);
    op_ = make_operator<D>(setup.method, p_, pairs_, kernel_, h_);
    Q_ = Field(static_cast<std::size_t>(p_.total), D * D);
  }

  Mat<D> deformation_gradient(Index i) const override {
    return Mat<D>::Identity() + displacement_gradient(i);
  }
  Mat<D> first_piola_kirchhoff(Index i) const override { return stress(i, displacement_gradient(i)); }
  Mat<D> cauchy_stress(Index i) const override {
    return full_cauchy_stress(i).template topLeftCorner<D, D>();
  }
  Mat<3> full_cauchy_stress(Index i) const override {
    return materials_[p_.material[static_cast<std::size_t>(i)]]->cauchy_stress(deformation_gradient(i));
  }
  void visit_stresses(const std::function<void(const StressSample<D>&)>& f) const override {
    for (Index i = 0; i < p_.n; ++i) {
      const Mat<D> H = displacement_gradient(i), F = Mat<D>::Identity() + H;
      f({p_.X.template vec<D>(i), {&i, 1}, p_.material[static_cast<std::size_t>(i)], F, stress(i, H)});
    }
  }

  std::vector<Index> bodies() const override {
    DisjointSets sets(p_.n);
    for (Index a = 0; a < p_.n; ++a)
      pairs_.for_each(a, [&](Index b, std::int64_t, int) {
        sets.join(a, b < p_.n ? b : p_.mirror.master(b - p_.mirror.begin()));
      });
    for (std::size_t k = 0; k + 1 < p_.ties.begin.size(); ++k)
      for (std::size_t i = p_.ties.begin[k] + 1; i < p_.ties.begin[k + 1]; ++i)
        sets.join(p_.ties.particles[i - 1], p_.ties.particles[i]);
    return sets.numbers();
  }
  void check(Health& health) const override { check_pair_operator<D>(p_, pairs_, op_, health); }
  MotionSample motion() const override { return pair_motion<D>(p_, pairs_, op_); }

  std::int64_t pairs() const override { return pairs_.pairs(); }
  std::size_t bytes() const override {
    return pairs_.bytes() + op_.bytes() + Q_.bytes() + (p_.rule ? p_.rule->bytes() : 0);
  }

 protected:
  /// H = F - I of particle i.
  Mat<D> displacement_gradient(Index i) const {
    Pack H[D * D];
    gradient(i / lanes, p_.u, H);
    Mat<D> value;
    for (int c = 0; c < D * D; ++c) value(c / D, c % D) = H[c][i % lanes];
    return value;
  }
  /// P of particle i where its displacement gradient is H.
  Mat<D> stress(Index i, const Mat<D>& H) const {
    Pack gradient[D * D];
    for (int c = 0; c < D * D; ++c) gradient[c] = pack(H(c / D, c % D));
    std::array<double, D * D * lanes> block;
    std::array<double, D * lanes> diagonal;
    deform<D>(gradient, lanes, block.data(), diagonal.data());
    materials_[p_.material[static_cast<std::size_t>(i)]]->stress(
        {lanes, lanes, block.data(), block.data(), nullptr, diagonal.data()});
    Mat<D> P;
    for (int c = 0; c < D * D; ++c) P(c / D, c % D) = block[static_cast<std::size_t>(c * lanes)];
    return P;
  }
  /// grad u of slice s, outside the step's loops.
  void gradient(Index s, const Field& u, Pack (&H)[D * D]) const {
    with_payload<D>(op_, pairs_, p_.X, [&](const auto& payload) {
      gradient_of_slice<D>(s, pairs_, payload, Columns<D>(u), {op_, s}, H);
    });
  }
  /// Lanes behind the last particle do as it does, so that they neither break nor widen the bounds.
  void fill_padding(Index s, Pack (&H)[D * D]) const {
    const int used = p_.n - s * lanes;
    for (int l = used; l < lanes; ++l)
      for (int k = 0; k < D * D; ++k) H[k][l] = H[k][used - 1];
  }

  MaterialGroups groups_;
  Kernel kernel_;
  double h_;
  PairList pairs_;
  PairOperator<D> op_;
  Field Q_;  ///< V_a P_a M_a
};

}  // namespace taut
