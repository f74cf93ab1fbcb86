#pragma once
/// \file
/// What all total Lagrangian forms have in common.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/formulations/stretch_bounds.hpp>
#include <vector>

namespace taut {

/// Displacement gradients H of eight particles become deformation gradients F = I + H, and go into a block
/// for materials: component c at F[c * stride], the diagonal of H beside it.
template <int D>
TAUT_INLINE void deform(Pack (&H)[D * D], std::size_t stride, double* F, double* H_diagonal) {
  for (std::size_t d = 0; d < D; ++d) {
    store(H_diagonal + d * stride, H[d * (D + 1)]);
    H[d * (D + 1)] += 1.0;
  }
  for (std::size_t c = 0; c < D * D; ++c) store(F + c * stride, H[c]);
}

/// Hyperelastic materials, and how fast they are. Forms set `frequency_` once and `stretch_` in each
/// update.
template <int D>
class HyperelasticForm : public Formulation<D> {
 protected:
  using Formulation<D>::p_;

 public:
  explicit HyperelasticForm(const FormulationSetup<D>& setup) : Formulation<D>(setup) {
    for (const auto& material : p_.materials)  // of the kind that the traits ask for
      materials_.push_back(&dynamic_cast<const Hyperelastic<D>&>(*material));
  }

  Fastest fastest() const override {
    double ratio = 1;
    for (const auto* material : materials_) {
      const double now = material->wave_speed(stretch_.min, stretch_.max, stretch_.J_min, stretch_.J_max) /
                         material->wave_speed();
      if (std::isnan(now)) return {.frequency = now};
      ratio = std::max(ratio, now);
    }
    return {.frequency = frequency_ * ratio};
  }
  double frequency() const override { return frequency_; }
  Index stiffest() const override { return stiffest_; }

 protected:
  void fail_inverted(Index particle) {
    if (this->failure_) return;
    // J of a gradient that has overflowed, or of displacements about to, says nothing.
    const Mat<D> F = this->deformation_gradient(particle);
    const bool finite = std::isfinite(p_.u.template vec<D>(particle).squaredNorm()) &&
                        std::isfinite(F.squaredNorm()) && std::isfinite(F.determinant());
    this->failure_ = Failure{finite ? "J <= 0" : "not a number", particle};
  }
  void need_energies() const {
    for (const auto* material : materials_)
      if (!material->has_energy())
        throw InputError(fmt::format("material \"{}\" has no stored energy", material->name()));
  }

  std::vector<const Hyperelastic<D>*> materials_;
  StretchBounds stretch_;
  double frequency_ = 0;          ///< of the stiffest mode of the body at rest [rad/s], or a bound
  Index stiffest_ = no_particle;  ///< particle that moves most in it
};

}  // namespace taut
