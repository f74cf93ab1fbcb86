#pragma once
/// \file
/// What all total Lagrangian forms have in common.

#include <fmt/format.h>

#include <algorithm>
#include <taut/core/error.hpp>
#include <taut/core/formulation.hpp>
#include <taut/internal/stretch_bounds.hpp>
#include <vector>

namespace taut {

/// Hyperelastic materials, and the step that they allow. Forms set `frequency_` once and `stretch_` in each
/// update.
template <int D>
class HyperelasticForm : public Formulation<D> {
 protected:
  using Formulation<D>::p_;

 public:
  explicit HyperelasticForm(const FormulationSetup<D>& setup) : Formulation<D>(setup) {
    for (const auto& material : p_.materials) {
      const auto* hyperelastic = dynamic_cast<const Hyperelastic<D>*>(material.get());
      if (!hyperelastic)
        throw InputError(
            fmt::format("{} needs a hyperelastic material; \"{}\" gives stress rates. Valid: "
                        "linear_elastic, st_venant_kirchhoff, corotated_svk, neo_hookean",
                        setup.method.formulation, material->name()));
      materials_.push_back(hyperelastic);
    }
  }

  double stable_step() const override {
    double ratio = 1;
    for (const auto* material : materials_)
      ratio =
          std::max(ratio, material->wave_speed(stretch_.min, stretch_.max, stretch_.J_min, stretch_.J_max) /
                              material->wave_speed());
    return 2 / (frequency_ * ratio);
  }
  double frequency() const override { return frequency_; }
  Index stiffest() const override { return stiffest_; }

 protected:
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

  std::vector<const Hyperelastic<D>*> materials_;
  StretchBounds stretch_;
  double frequency_ = 0;  ///< of the stiffest mode of the body at rest [rad/s], or a bound
  Index stiffest_ = no_particle;  ///< particle that moves most in it
};

}  // namespace taut
