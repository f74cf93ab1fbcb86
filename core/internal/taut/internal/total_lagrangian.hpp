#pragma once
/// \file
/// What the total Lagrangian forms on pairs have in common.

#include <Eigen/LU>
#include <array>
#include <taut/core/operators.hpp>
#include <taut/internal/health.hpp>
#include <taut/internal/hyperelastic_form.hpp>
#include <taut/internal/material_groups.hpp>
#include <taut/internal/pair_passes.hpp>
#include <taut/neighbors/search.hpp>

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
    pairs_ = find_pairs<D>(points_of<D>(p_.X, p_.total), setup.method.support_dx * p_.dx,
                           {search_method(setup.method.neighbours)});
    op_ = make_operator<D>(setup.method, p_, pairs_, kernel_, h_);
    Q_ = Field(static_cast<std::size_t>(p_.total), D * D);
  }

  Mat<D> deformation_gradient(Index i) const override {
    Pack F[D * D];
    gradient(i / lanes, p_.x, F);
    Mat<D> value;
    for (int c = 0; c < D * D; ++c) value(c / D, c % D) = F[c][i % lanes];
    return value;
  }
  Mat<D> first_piola_kirchhoff(Index i) const override {
    return stress(i, deformation_gradient(i));
  }
  Mat<D> cauchy_stress(Index i) const override {
    const Mat<D> F = deformation_gradient(i);
    return stress(i, F) * F.transpose() / F.determinant();
  }
  void visit_stresses(const std::function<void(const StressSample<D>&)>& f) const override {
    for (Index i = 0; i < p_.n; ++i) {
      const Mat<D> F = deformation_gradient(i);
      f({p_.X.template vec<D>(i), {&i, 1}, p_.material[static_cast<std::size_t>(i)], F, stress(i, F)});
    }
  }

  void check(Health& health) const override { check_pair_operator<D>(p_, pairs_, op_, health); }
  MotionSample motion() const override { return pair_motion<D>(p_, pairs_, op_); }

  std::int64_t pairs() const override { return pairs_.pairs(); }
  std::size_t bytes() const override { return pairs_.bytes() + op_.bytes() + Q_.bytes(); }

 protected:
  /// P of particle i where its deformation gradient is F.
  Mat<D> stress(Index i, const Mat<D>& F) const {
    std::array<double, D * D * lanes> block{};
    for (int c = 0; c < D * D; ++c)
      for (int l = 0; l < lanes; ++l) block[static_cast<std::size_t>(c * lanes + l)] = F(c / D, c % D);
    materials_[p_.material[static_cast<std::size_t>(i)]]->stress(
        {lanes, lanes, block.data(), block.data(), nullptr});
    Mat<D> P;
    for (int c = 0; c < D * D; ++c) P(c / D, c % D) = block[static_cast<std::size_t>(c * lanes)];
    return P;
  }
  /// F of slice s, outside the step's loops.
  void gradient(Index s, const Field& x, Pack (&F)[D * D]) const {
    with_payload<D>(op_, pairs_, p_.X, [&](const auto& payload) {
      gradient_of_slice<D>(s, pairs_, payload, Columns<D>(x), {op_, s}, F);
    });
    add_offset(s, F);
  }
  TAUT_INLINE void add_offset(Index s, Pack (&F)[D * D]) const {
    if (op_.F0.empty()) return;
    for (int k = 0; k < D * D; ++k) F[k] += load(op_.F0.component(k) + s * lanes);
  }
  /// Lanes behind the last particle do as it does, so that they neither break nor widen the bounds.
  void fill_padding(Index s, Pack (&F)[D * D]) const {
    const int used = p_.n - s * lanes;
    for (int l = used; l < lanes; ++l)
      for (int k = 0; k < D * D; ++k) F[k][l] = F[k][used - 1];
  }

  MaterialGroups groups_;
  Kernel kernel_;
  double h_;
  PairList pairs_;
  PairOperator<D> op_;
  Field Q_;  ///< V_a P_a M_a
};

}  // namespace taut
