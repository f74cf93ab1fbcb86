#pragma once
/// \file
/// What the total Lagrangian forms on one operator have in common.

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <taut/core/error.hpp>
#include <taut/core/formulation.hpp>
#include <taut/core/operators.hpp>
#include <taut/internal/material_groups.hpp>
#include <taut/internal/pair_passes.hpp>
#include <taut/internal/stretch_bounds.hpp>
#include <taut/neighbors/search.hpp>
#include <vector>

namespace taut {

/// Hyperelastic materials, pairs and their operator, and the state of a particle that follows from its
/// deformation gradient. Forms set `frequency_` once and `stretch_` in each update.
template <int D>
class TotalLagrangian : public Formulation<D> {
 protected:
  using Formulation<D>::p_;

 public:
  explicit TotalLagrangian(const FormulationSetup<D>& setup)
      : Formulation<D>(setup),
        groups_(p_),
        kernel_(setup.method.kernel, D),
        h_(setup.method.support_dx * p_.dx / kernel_.radius_factor()) {
    for (const auto& material : p_.materials) {
      const auto* hyperelastic = dynamic_cast<const Hyperelastic<D>*>(material.get());
      if (!hyperelastic)
        throw InputError(
            fmt::format("{} needs a hyperelastic material; \"{}\" gives stress rates. Valid: "
                        "linear_elastic, st_venant_kirchhoff, corotated_svk, neo_hookean",
                        setup.method.formulation, material->name()));
      materials_.push_back(hyperelastic);
    }
    pairs_ = find_pairs<D>(points_of<D>(p_.X, p_.total), setup.method.support_dx * p_.dx,
                           {search_method(setup.method.neighbours)});
    op_ = make_operator<D>(setup.method, p_, pairs_, kernel_, h_);
    Q_ = Field(static_cast<std::size_t>(p_.total), D * D);
  }

  double stable_step() const override {
    double ratio = 1;
    for (const auto* material : materials_)
      ratio =
          std::max(ratio, material->wave_speed(stretch_.min, stretch_.max, stretch_.J_min, stretch_.J_max) /
                              material->wave_speed());
    return 2 / (frequency_ * ratio);
  }

  Mat<D> deformation_gradient(Index i) const override {
    Pack F[D * D];
    gradient(i / lanes, p_.x, F);
    Mat<D> value;
    for (int c = 0; c < D * D; ++c) value(c / D, c % D) = F[c][i % lanes];
    return value;
  }
  Mat<D> first_piola_kirchhoff(Index i) const override {
    std::array<double, D * D * lanes> block{};
    const Mat<D> F = deformation_gradient(i);
    for (int c = 0; c < D * D; ++c)
      for (int l = 0; l < lanes; ++l) block[static_cast<std::size_t>(c * lanes + l)] = F(c / D, c % D);
    materials_[p_.material[static_cast<std::size_t>(i)]]->stress(
        {lanes, lanes, block.data(), block.data(), nullptr});
    Mat<D> P;
    for (int c = 0; c < D * D; ++c) P(c / D, c % D) = block[static_cast<std::size_t>(c * lanes)];
    return P;
  }
  Mat<D> cauchy_stress(Index i) const override {
    const Mat<D> F = deformation_gradient(i);
    return first_piola_kirchhoff(i) * F.transpose() / F.determinant();
  }

  std::int64_t pairs() const override { return pairs_.pairs(); }
  std::size_t bytes() const override { return pairs_.bytes() + op_.bytes() + Q_.bytes(); }

 protected:
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
  void fail_inverted(Index particle) {
    if (this->failure_) return;
    this->failure_ =
        Failure{p_.x.template vec<D>(particle).allFinite() ? "J <= 0" : "not a number", particle};
  }
  void need_energies() const {
    for (const auto* material : materials_)
      if (!material->has_energy())
        throw InputError(fmt::format("material \"{}\" has no stored energy", material->name()));
  }

  MaterialGroups groups_;
  Kernel kernel_;
  double h_;
  std::vector<const Hyperelastic<D>*> materials_;
  PairList pairs_;
  PairOperator<D> op_;
  Field Q_;  ///< V_a P_a M_a
  StretchBounds stretch_;
  double frequency_ = 0;  ///< of the stiffest mode of the body at rest [rad/s], or a bound
};

}  // namespace taut
