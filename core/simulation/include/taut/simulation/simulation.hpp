#pragma once
/// \file
/// A body, a method, boundary conditions; run it, look at it.

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <taut/base/types.hpp>
#include <taut/formulations/health.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/materials/material.hpp>
#include <taut/operators/method.hpp>
#include <vector>

namespace taut {

/// How and where a formulation broke. A result, not an error.
struct Breakdown {
  std::string what;                ///< "J <= 0", "not a number", "runaway energy", "lost neighbours", …
  std::int64_t particle = -1;      ///< the user's id: index in the cloud as given; -1: none is to blame
  std::array<double, 3> X{}, x{};  ///< reference and current position [m] (unused components zero)
  double time = 0;                 ///< [s]
  std::int64_t step = 0;
};

enum class Status { ok, broke, not_converged };
/// "ok", "broke", "not_converged".
const char* to_string(Status status);

/// What a run did.
struct RunResult {
  Status status = Status::ok;
  std::optional<Breakdown> breakdown;
  std::int64_t steps = 0;
  double time = 0;              ///< simulated time reached [s]
  double loop_seconds = 0;      ///< wall time of the time loop
  double residual = 0;          ///< relax: |out-of-balance force| / |applied force| at the end
  double remaining_motion = 0;  ///< relax: what the slowest motion has still to go over what it has come
  std::int64_t rebuilds = 0;    ///< updated Lagrangian: pair list rebuilds
  Health health;                ///< what the run tells of its own trustworthiness

  /// Whether a measure of `health` is beyond its limit: the answer may be wrong, whatever the status.
  bool suspect() const { return health.suspect(); }
};

/// Progress of a running loop: steps done, simulated time, fraction done (0..1; an estimate for relax).
/// Return false to stop the run.
using Progress = std::function<bool(std::int64_t steps, double time, double fraction)>;

struct RunOptions {
  std::string integrator = "leapfrog";  ///< one of `integrator_names`
  double cfl =
      0.6;  ///< fraction of the integrator's largest step, 0 < cfl <= 1; more only beside a `max_step`
  double max_step = 0;  ///< upper bound of the step [s]; 0 = none
  Progress progress{};
};

struct RelaxOptions {
  double tolerance =
      1e-6;  ///< wanted |out-of-balance force| / |applied force|, the largest seen where no force is applied
  static constexpr double still_moving =
      1e-4;  ///< the second condition of equilibrium: `remaining_motion` at most
  /// Loads grow smoothly over this time [s]; 0: full at once. They grow from the part of them that acts
  /// already: none at first, all after a `run` or a ramp that came to its end, what there was of a ramp that
  /// did not.
  double ramp_time = 0;
  double free_time = 0;  ///< motion without damping for this time [s] first: what sudden loads do to a body
  std::int64_t max_steps = 10'000'000;
  double cfl = 0.6;
  Progress progress{};
};

/// Which particles: a predicate of the reference position.
template <int D>
using Where = std::function<bool(const Vec<D>& X)>;
/// A history in time, of all or of each point by its reference position.
using History = std::function<double(double t)>;
template <int D>
using PointHistory = std::function<double(const Vec<D>& X, double t)>;

template <int D>
struct SimulationImpl;

template <int D>
class StressRecovery;
template <int D>
class Simulation;
template <int D>
void write_vtkhdf(const std::string& file, const Simulation<D>& simulation);
template <int D>
void read_field(const Simulation<D>& simulation, std::string_view name, std::span<double> out);

/// One or more bodies under one method. Everything is set before the first `run` or `relax`; set-up
/// (ordering, pair lists, operators) happens then, or when `prepare` is called.
///
/// Errors are `taut::Error`s; std::bad_alloc and what functions of the user's throw come out as they are. A
/// call that throws leaves the simulation as it was before, with these exceptions. A run that ends with an
/// error between two steps (out of an observer or a progress call) leaves the state of the last step. One
/// that ends within a step (out of a material, a history, a prescribed displacement) leaves a state that
/// can be looked at, but the simulation cannot go on and says so.
///
/// Functions that are called meanwhile may look at the simulation and add observers, but not set it up or
/// run it. One that has been moved from can be assigned to and destroyed; every other call is an InputError.
/// Ids are the indices of the cloud; others are an InputError.
template <int D>
class Simulation {
 public:
  /// \throws InputError for unknown names, a material the formulation cannot take, and what the parts throw.
  Simulation(Cloud<D> cloud, std::shared_ptr<const Material<D>> material, Method method);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// The named face of the body's bounding box: "x_min" … "z_max": its outermost particles or, where the
  /// operators act through facets (`compatible`, `antisymmetric`) and the cloud has some, the facets there.
  Where<D> face(std::string_view name) const;

  /// Another material for a region (bonded to the rest): on node-centred lattices for the cells whose centres
  /// lie in it, elsewhere for its particles. A particle between cells of two materials has volume and mass of
  /// both, and in total Lagrangian forms on pairs a stress of each, made of its neighbours in that material
  /// alone; jitter is taken back there. Its stress, as asked for, is that of the material set last at the
  /// particle itself. A region that holds particles but no cell makes all materials the particles', as
  /// without cells; those of updated Lagrangian forms always are.
  void set_material(const Where<D>& where, std::shared_ptr<const Material<D>> material);
  void set_velocity(const std::function<Vec<D>(const Vec<D>& X)>& velocity);
  /// Initial displacement; constraints still hold.
  void set_displacement(const std::function<Vec<D>(const Vec<D>& X)>& displacement);

  // Boundary conditions and loads. Each \throws InputError when it selects no particle. Conditions act on the
  // particles that `where` selects by their reference position and, with operators that act through facets,
  // on the facets whose centres it selects, those of selected particles aside: a wall there holds the
  // displacement that is extrapolated to the facet, half a spacing beyond the outermost particles of a
  // cell-centred lattice.
  void clamp(const Where<D>& where);             ///< displacement zero
  void roller(const Where<D>& where, int axis);  ///< displacement zero along one axis
  /// Displacement along `axis` follows `displacement(X, t)` or, the same for all and asked for once a step,
  /// `displacement(t)`; velocities follow `velocity`, or differences of the displacements from t = 0 on.
  void prescribe(const Where<D>& where, int axis, PointHistory<D> displacement,
                 PointHistory<D> velocity = {});
  void prescribe(const Where<D>& where, int axis, History displacement, History velocity = {});
  /// Dead load: `force` [N] (per unit thickness in 2D, per unit area in 1D) spread over the selected
  /// particles by their boundary area along the face normal, or evenly where areas are unknown; times
  /// `history`. With facets over those selected and those of selected particles, from where it is carried to
  /// the particles by the weights of the extrapolation.
  void load(const Where<D>& where, const Vec<D>& force, History history = {});
  void body_force(const Vec<D>& acceleration, History history = {});  ///< [m/s^2]
  /// The body continues as its mirror image beyond the plane X[axis] = `at` [m], which must bound it.
  /// Particles on the plane slide in it. The loads of a scene are those of the part that is modelled.
  void symmetry_plane(int axis, double at);
  /// The body repeats itself along the axis, once every `high` - `low` [m], between which it lies. Particles
  /// must not lie on both ends, which are one place, except with formulations on cells: there the nodes of
  /// both ends must match, and are tied. Displacements and velocities are periodic. \throws InputError for an
  /// axis that has a symmetry plane or a period already, and in `prepare` for a body that does not fit.
  void periodic(int axis, double low, double high);

  /// \throws InputError for what the parts refuse: particles that coincide or whose neighbours do not span
  /// the space, masses and stable steps that are no positive finite numbers.
  void prepare();
  /// Advances the time by `duration` [s], in steps that do not know where the run ends: the last one is as
  /// long as the others where that meets the end to a millionth of a step, else it is cut. Where it is not, a
  /// run of the same options goes on as if there had been no end: run(T), run(T) gives the bits of run(2 T).
  /// Loads act as they are given, whatever a ramp of `relax` came to. Velocities are of the time of positions
  /// after the run, and for observers and progress calls; looking at them does not change the bits of what
  /// follows. What these calls throw ends the run after a whole step, from where another goes on; what
  /// materials and histories throw within a step leaves no state to go on from. \throws InputError as
  /// `check_run`, RunError when an earlier error has left no state to go on from.
  RunResult run(double duration, const RunOptions& options = {});
  /// \throws InputError as `check_relax`, RunError as `run`.
  RunResult relax(const RelaxOptions& options = {});
  /// What `run` does before its first step. \throws InputError as `prepare`, for options out of range, and
  /// for steps too small ever to reach the end in the resolution of time (2^-53 of it).
  void check_run(double duration, const RunOptions& options = {});
  /// What `relax` does before its first step. \throws InputError as `prepare`, for options out of range, and
  /// for loads that set a body in a rigid motion that nothing holds: which body and which motions.
  void check_relax(const RelaxOptions& options = {});
  /// Calls `f(t)` at the start and after every `interval` seconds of simulated time (each step when 0) of
  /// `run`. Observers may add others, which see the same step. \throws InputError for an interval that is
  /// negative or not finite.
  void observe(double interval, std::function<void(double t)> f);

  // State, in the user's order of particles.
  std::size_t size() const;
  double dx() const;  ///< nominal spacing [m]
  double time() const;
  Vec<D> reference_position(std::size_t id) const;
  Vec<D> position(std::size_t id) const;
  Vec<D> displacement(std::size_t id) const;
  Vec<D> velocity(std::size_t id) const;
  /// [m/s^2] of the last step, constrained components zero; of the present state after run(0).
  Vec<D> acceleration(std::size_t id) const;
  Mat<D> cauchy_stress(std::size_t id) const;
  /// The Cauchy stress with the axes that the body does not have: sigma_zz of plane strain, sigma_yy =
  /// sigma_zz of 1D, zeros of plane stress. What von_mises and its like take (derived.hpp). \throws
  /// InputError for a material or a formulation of the user's own that does not give them.
  Mat<3> full_cauchy_stress(std::size_t id) const;
  Mat<D> first_piola_kirchhoff(std::size_t id) const;  ///< \throws InputError for updated Lagrangian forms
  Mat<D> deformation_gradient(std::size_t id) const;   ///< \throws InputError for updated Lagrangian forms
  double mass(std::size_t id) const;
  /// Displacement at a reference point: linear least squares over the nearest particles (exact on a
  /// particle). It extrapolates beyond the body, by up to three spacings from the nearest particle: asking
  /// for points that lie in it is up to the caller. \throws InputError farther out.
  Vec<D> displacement_at(const Vec<D>& X) const;
  /// The same, to the last bit, for many points, in a time that hardly depends on the number of particles.
  std::vector<Vec<D>> displacements_at(std::span<const Vec<D>> X) const;

  double kinetic_energy() const;   ///< [J]
  double strain_energy() const;    ///< [J]; hyperelastic total Lagrangian forms only
  Vec<D> linear_momentum() const;  ///< [kg m/s]

  std::int64_t pairs() const;  ///< directed pairs
  std::size_t bytes() const;   ///< memory of state, pair lists and operators
  double setup_seconds() const;
  /// Measures of set-up after `prepare`, those of the last `run` or `relax` behind them. \throws InputError
  /// before.
  const Health& health() const;
  const Method& method() const;

 private:
  friend class StressRecovery<D>;
  friend void write_vtkhdf<D>(const std::string&, const Simulation<D>&);
  friend void read_field<D>(const Simulation<D>&, std::string_view, std::span<double>);
  SimulationImpl<D>& impl() const;
  std::shared_ptr<SimulationImpl<D>> impl_;  // a loop that runs keeps it alive
};

/// Fields of the present state as VTKHDF (ParaView): displacement, velocity, the whole Cauchy stress (nine
/// components), von_mises, mass, id. Stresses that the material does not give are NaN. \throws RunError when
/// the file cannot be written or this build has no HDF5.
template <int D>
void write_vtkhdf(const std::string& file, const Simulation<D>& simulation);
/// Whether this build writes VTKHDF files.
bool has_field_output();

}  // namespace taut
