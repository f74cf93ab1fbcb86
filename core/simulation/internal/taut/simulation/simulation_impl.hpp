#pragma once
/// \file
/// What a Simulation is made of; shared by its set-up, its loops and its look at the state.

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <taut/boundary/constraints.hpp>
#include <taut/boundary/loads.hpp>
#include <taut/boundary/mirror.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/integrators/step_control.hpp>
#include <taut/operators/facet_rows.hpp>
#include <taut/particles/interfaces.hpp>
#include <taut/simulation/health_watch.hpp>
#include <taut/simulation/simulation.hpp>
#include <vector>

namespace taut {

/// The time of the integrator: steps of one length are counted, not added up, so that it does not depend on
/// where runs begin and end.
struct StepClock {
  double start = 0, step = 0;
  std::int64_t count = 0;

  double now() const { return start + static_cast<double>(count) * step; }
  void advance(double dt) {
    if (dt != step) *this = {now(), dt, 0};
    ++count;
  }
};

/// What a simulation is given.
template <int D>
struct SimulationInput {
  Cloud<D> cloud;  // in coordinates of its own, from cloud.origin; users see positions from theirs
  Method method;
  std::vector<std::shared_ptr<const Material<D>>> materials;
  std::vector<std::uint8_t> material;                // of each user's particle
  std::shared_ptr<const Interfaces<D>> interfaces;   // where cells are known and there are several materials
  std::vector<typename MirrorMap<D>::Plane> planes;  // in the cloud's coordinates
  std::vector<typename MirrorMap<D>::Period> periods;  // likewise
  std::vector<std::function<void()>> conditions;       // boundary conditions, applied when places are known
  std::function<Vec<D>(const Vec<D>&)> initial_velocity, initial_displacement;
};

/// What its set-up makes of that. The formulation refers to what stands before it.
template <int D>
struct SimulationBuilt {
  Particles<D> particles;
  FacetRows<D> facet_rows;  // of the cloud's facets, once particles are in place
  Constraints<D> constraints;
  Loads<D> loads;
  std::unique_ptr<Formulation<D>> formulation;
  double setup_seconds = 0;
  Health health_of_setup, health;  // the latter with that of the last run
};

template <int D>
struct SimulationImpl : SimulationInput<D>, SimulationBuilt<D> {
  using SimulationInput<D>::cloud;
  using SimulationInput<D>::method;
  using SimulationInput<D>::materials;
  using SimulationInput<D>::interfaces;
  using SimulationInput<D>::planes;
  using SimulationBuilt<D>::particles;
  using SimulationBuilt<D>::facet_rows;
  using SimulationBuilt<D>::constraints;
  using SimulationBuilt<D>::loads;
  using SimulationBuilt<D>::formulation;
  struct Observer {
    double interval, next;
    std::function<void(double)> f;
  };

  std::list<Observer> observers;  // one may add another while it is called
  StepControl step_control;
  // Of the last run, where its state is still the present one: another run goes on with it.
  std::string integrator_name;
  std::unique_ptr<Integrator> integrator;
  StepClock clock;
  double time = 0;
  double load_level = 0;     // the part of the loads that acts at the end of the last run or relaxation
  HealthBalance<D> balance;  // at the start of runs that conserve energy

  const char* busy = nullptr;  // prepare, run or relax, while it lasts
  mutable bool mid_step = false;
  std::string lost;  // why there is no way on, if there is none

  // What throws from here to `step_ends` leaves a state of no time.
  void step_begins() { mid_step = true; }
  void step_ends() { mid_step = false; }
  /// Runs one of the loops. Where something throws before the first step the state is as it was, between two
  /// steps it is that of the last; within a step it is lost, and so is the simulation.
  template <class Loop>
  RunResult guarded(const char* what, Loop&& loop);
  void recover(const char* error);

  // To be called before velocities are read.
  void look() const {
    if (!integrator) return;
    mid_step = true;
    integrator->complete(*formulation, clock.now());
    mid_step = false;
  }
  /// Throws unless the user has such a particle.
  std::size_t known(std::size_t id) const;
  Index place(std::size_t id) const { return particles.place[known(id)]; }
  Vec<D> reference_position(std::size_t id) const { return cloud.origin + cloud.X[known(id)]; }
  /// What a condition acts on: particles, and facets that none of them owns.
  struct Selected {
    std::vector<Index> particles, facets;
  };
  // Throws while prepare, run or relax lasts.
  void must_be_idle(const char* what) const;
  // Throws when a set-up call comes too late. Facets are selected by their centres.
  Selected select(const Where<D>& where, const char* what) const;
  std::vector<Index> select_particles(const Where<D>& where, const char* what) const;
  void must_be_open(const char* what) const;
  std::vector<Index> places(std::vector<Index> ids) const;  // all twins
  // The interfaces, if the method resolves them; else null.
  const Interfaces<D>* met() const;
  void prescribe(const Where<D>& where, int axis, PrescribedMotion<D> motion);
  void hold(const Selected& selected, int axis, const PrescribedMotion<D>& motion);
  void add_load(const Selected& selected, const Vec<D>& force, History history);
  bool add_traction(const Selected& selected, const Vec<D>& force, const History& history);
  void place_facets();
};

/// Makes particles, conditions and formulation of what the simulation was given. What throws leaves it half
/// way.
template <int D>
void build(SimulationImpl<D>& simulation);
/// Whether steps of this length reach the end: not if they are lost in its rounding.
bool advances(double end, double step);
/// Times from now on at which histories are asked what a relaxation has ahead of it [s].
template <int D>
std::vector<double> relaxation_times(const SimulationImpl<D>& simulation, const RelaxOptions& options);

/// Advances by `duration` [s]; the loop of Simulation::run.
template <int D>
RunResult integrate(SimulationImpl<D>& simulation, double duration, const RunOptions& options);
/// Relaxes to static equilibrium; the loop of Simulation::relax.
template <int D>
RunResult find_equilibrium(SimulationImpl<D>& simulation, const RelaxOptions& options);

}  // namespace taut
