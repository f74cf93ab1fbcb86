#pragma once
/// \file
/// Smoothed stresses for output.

#include <taut/operators/patch_fit.hpp>
#include <taut/simulation/simulation.hpp>
#include <vector>

namespace taut {

/// Stresses at the particles of a total Lagrangian simulation, recovered from those that the formulation has
/// where it is most accurate: at the centres of the cells of `tl_stress_points`, at the particles of the
/// other forms. A quadratic fit around each particle (`PatchFit`; Zienkiewicz & Zhu 1992) carries them up to
/// the faces and takes out what varies from one sample to the next. `Simulation::cauchy_stress` gives what
/// is integrated instead; for stress points that is the mean over a particle's cells, of first order at
/// faces. The swinging cube of `taut-convergence cube` shows both.
///
/// Fits see neither other bodies (those that the formulation does not couple) nor other materials; a particle
/// on the border of two has the stress of its own one. Nor do they look across slits and re-entrant corners,
/// where the formulation's pairs do not. Nothing is added to a time step: fits are made once, in the
/// reference configuration.
template <int D>
class StressRecovery {
 public:
  static constexpr double default_support_dx = 3.2;
  /// Of a simulation that outlives this. Samples within `support_dx` spacings are fitted: more of them even
  /// out more of the noise of irregular clouds, and see further around corners. \throws InputError before the
  /// simulation is prepared, for a formulation in rate form, and for a support that is less than 2 (which
  /// determines no quadratic on lattices) or more than 20.
  explicit StressRecovery(const Simulation<D>& simulation, double support_dx = default_support_dx);

  // Of the present state, in the user's order of particles [Pa].
  std::vector<Mat<D>> first_piola_kirchhoff() const;
  std::vector<Mat<D>> cauchy_stress() const;
  /// With the axes that the body does not have, as `Simulation::full_cauchy_stress`; NaN where a user's
  /// material does not give them.
  std::vector<Mat<3>> full_cauchy_stress() const;

  std::size_t bytes() const { return fit_.bytes(); }

 private:
  template <class F>
  std::vector<Mat<D>> recover(F&& of_sample) const;

  const SimulationImpl<D>* simulation_;
  PatchFit<D> fit_;
};

}  // namespace taut
