#pragma once
/// \file
/// What a formulation is to the rest of taut, and the registry of formulations.

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <taut/boundary/constraints.hpp>
#include <taut/boundary/loads.hpp>
#include <taut/formulations/health.hpp>
#include <taut/integrators/dynamics.hpp>
#include <taut/integrators/step_limits.hpp>
#include <taut/operators/method.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

/// Why a state cannot be continued, and which particle shows it (internal index).
struct Failure {
  std::string what;
  Index particle = 0;
};

/// A stress that a formulation has of its own, as total Lagrangian forms do.
template <int D>
struct StressSample {
  Vec<D> X;  ///< where, in the reference configuration, as `Particles::X` relative to `Particles::origin` [m]
  std::span<const Index> particles;  ///< the one it stands on, or the corners of the cell it stands in
  std::uint8_t material;             ///< which of the particles' materials it is of
  Mat<D> F, P;                       ///< deformation gradient, first Piola-Kirchhoff stress [Pa]
};

/// What every formulation gets: it keeps references, so all must outlive it.
template <int D>
struct FormulationSetup {
  Particles<D>& particles;
  const Constraints<D>& constraints;
  const Loads<D>& loads;
  const Method& method;
};

/// The spatial discretisation of a body: accelerations from the state of its particles. Positions are
/// displacements: as the state they keep the digits of small strains, however far the particles stand from
/// the origin. A new formulation is one class in one file and one line in `formulation_registry`
/// (formulation.cpp).
template <int D>
class Formulation : public Dynamics {
 public:
  explicit Formulation(const FormulationSetup<D>& setup);

  void constrain_positions(double t) override { constraints_.apply_to_displacements(t, p_.X, p_.u); }
  void constrain_velocities(double t) override {
    // Differences of histories over what changes within a step.
    if (!constraints_.empty())
      constraints_.apply_to_velocities(t, p_.X, p_.v, 0.25 * stable_step(leapfrog_limits, fastest()));
  }
  bool constraints_project() const override { return constraints_.projects(); }

  /// Set by the update that found the state broken.
  const std::optional<Failure>& failure() const { return failure_; }
  /// Checks too costly for every evaluation (lost neighbours, runaway energy); sets `failure`.
  virtual void inspect();

  virtual Mat<D> cauchy_stress(Index i) const = 0;
  /// The same with the axes that the body does not have; NaN along those where nothing is known, zero in
  /// plane stress. Unless it is overridden, that is all that is known.
  virtual Mat<3> full_cauchy_stress(Index i) const;
  /// \throws InputError where the formulation has no reference configuration.
  virtual Mat<D> deformation_gradient(Index i) const;
  virtual Mat<D> first_piola_kirchhoff(Index i) const;
  /// Calls f with all stresses of the present state, in an order that never changes: what output is smoothed
  /// from. \throws InputError where the formulation has no reference configuration.
  virtual void visit_stresses(const std::function<void(const StressSample<D>&)>& f) const;
  /// Of the modelled part of the body [J].
  virtual double strain_energy() const;
  /// For each particle the number of the body that it is part of: those that internal forces bind. One for
  /// all unless a form knows better.
  virtual std::vector<Index> bodies() const { return std::vector<Index>(static_cast<std::size_t>(p_.n), 0); }
  // Health: what the formulation can tell about itself.
  /// Adds the measures of set-up, of the reference configuration.
  virtual void check(Health&) const {}
  /// How rough the present motion is, for what the formulation sees of it; in about the time of a step.
  virtual MotionSample motion() const { return {}; }
  /// Roughness (energy of what gradients do not see over strain energy) up to which its answers are good.
  virtual double rough_limit() const { return std::numeric_limits<double>::infinity(); }
  /// Highest frequency of the body at rest [rad/s], and the particle that moves most in that mode; 0 where
  /// the step comes from elsewhere.
  virtual double frequency() const { return 0; }
  virtual Index stiffest() const { return no_particle; }

  virtual std::int64_t pairs() const = 0;
  virtual std::int64_t rebuilds() const { return 0; }
  virtual std::size_t bytes() const = 0;
  /// Of what every form keeps.
  std::size_t own_bytes() const { return companion_.size() * sizeof(Index); }

 protected:
  /// Applied loads, ties and constraints on top of the internal accelerations; the last act of
  /// update_accelerations.
  void finish_accelerations(double t);

  Particles<D>& p_;
  const Constraints<D>& constraints_;
  const Loads<D>& loads_;
  const Method& method_;
  std::optional<Failure> failure_;

 private:
  std::vector<Index> companion_;  // of each particle: one near by that it is bound to, or itself
};

/// \throws InputError listing the valid names, or when the formulation cannot take a material.
template <int D>
std::unique_ptr<Formulation<D>> make_formulation(const FormulationSetup<D>& setup);
std::vector<std::string> formulation_names();

}  // namespace taut
