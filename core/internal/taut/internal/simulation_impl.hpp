#pragma once
/// \file
/// What a Simulation is made of; shared by its set-up, its loops and its look at the state.

#include <functional>
#include <memory>
#include <taut/boundary/constraints.hpp>
#include <taut/boundary/loads.hpp>
#include <taut/boundary/mirror.hpp>
#include <taut/core/formulation.hpp>
#include <taut/core/simulation.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/integrators/step_control.hpp>
#include <taut/internal/health.hpp>
#include <vector>

namespace taut {

template <int D>
struct SimulationImpl {
  struct Observer {
    double interval, next;
    std::function<void(double)> f;
  };

  Cloud<D> cloud;
  Method method;
  std::vector<std::shared_ptr<const Material<D>>> materials;
  std::vector<std::uint8_t> material;  // of each user's particle
  std::vector<typename MirrorMap<D>::Plane> planes;
  std::vector<std::function<void()>> conditions;  // boundary conditions, applied when places are known
  std::function<Vec<D>(const Vec<D>&)> initial_velocity, initial_displacement;
  std::vector<Observer> observers;

  Particles<D> particles;
  Constraints<D> constraints;
  Loads<D> loads;
  std::unique_ptr<Formulation<D>> formulation;
  StepControl step_control;
  std::function<void()> complete_velocities;  // while a run leaves them at half steps
  double time = 0, setup_seconds = 0;
  Health health_of_setup, health;  // the latter with that of the last run
  double guessed_areas = -1;       // change that closing made to area vectors that were guessed
  HealthBalance<D> balance;        // at the start of runs that conserve energy

  // To be called before velocities are read.
  void look() const {
    if (complete_velocities) complete_velocities();
  }
  Index place(std::size_t id) const { return particles.place.at(id); }
  // Throws when a set-up call comes too late, and gives the ids that `where` selects.
  std::vector<Index> select(const Where<D>& where, const char* what) const;
  void must_be_open(const char* what) const;
  std::vector<Index> places(std::vector<Index> ids) const;
  void add_load(const std::vector<Index>& ids, const Vec<D>& force, History history);
};

/// Advances by `duration` [s]; the loop of Simulation::run.
template <int D>
RunResult integrate(SimulationImpl<D>& simulation, Integrator& integrator, double duration,
                    const RunOptions& options);
/// Relaxes to static equilibrium; the loop of Simulation::relax.
template <int D>
RunResult find_equilibrium(SimulationImpl<D>& simulation, const RelaxOptions& options);

}  // namespace taut
