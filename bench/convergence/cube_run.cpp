#include <chrono>
#include <cmath>
#include <convergence/cube_run.hpp>
#include <convergence/hexahedral_fem.hpp>
#include <convergence/run_row.hpp>
#include <taut/base/error.hpp>
#include <taut/materials/registry.hpp>
#include <taut/output/stress_recovery.hpp>

namespace taut::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Small against all spatial errors here: at 1/h = 8 halving it moves the errors of velocity by 2 % of their
/// size.
constexpr double courant = 0.25;

/// Instants in a quarter period at which errors are taken. An error at one time alone says little: waves that
/// start at the faces, where gradients are of first order, pass through zero at times that change with the
/// spacing.
constexpr int instants = 16;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

double step_of(int intervals) { return courant / intervals / SwingingCube::pressure_wave_speed(); }

Row row_of(const Cloud<3>& cloud, double jitter, int threads) {
  Row row;
  row.scene = std::string("swinging_cube_") + (jitter > 0 ? "jittered" : "lattice");
  row.material = "linear_elastic";
  row.dx = cloud.dx;
  row.particles = static_cast<std::int64_t>(cloud.size());
  row.threads = threads;
  row.integrator = "leapfrog";
  row.unit = std::string("1");
  return row;
}

/// Ready to run from time `start`. \throws InputError where the method cannot take the cube or the material.
Simulation<3> cube_simulation(const Cloud<3>& cloud, const Method& method, const std::string& material,
                              double start) {
  Simulation<3> simulation(cloud, make_material<3>(material, SwingingCube::material()), method);
  hold_swinging_cube(simulation);
  simulation.set_displacement([start](const Vec<3>& X) { return SwingingCube::displacement(X, start); });
  simulation.set_velocity([start](const Vec<3>& X) { return SwingingCube::velocity(X, start); });
  simulation.prepare();
  return simulation;
}

}  // namespace

CubeRun run_cube(const CubeSpec& spec, int threads) {
  const Cloud<3> cloud = swinging_cube_cloud(spec.intervals, spec.jitter, spec.seed);
  CubeRun run;
  run.row = row_of(cloud, spec.jitter, threads);
  set_method(run.row, spec.method);

  const double quarter = SwingingCube::quarter_period();
  double start = spec.undeformed ? -quarter : 0;
  std::optional<Simulation<3>> simulation;
  try {
    simulation.emplace(cube_simulation(cloud, spec.method, run.row.material, start));
  } catch (const InputError& error) {
    run.why = error.what();
  }
  if (!simulation) try {
      start = -quarter;
      simulation.emplace(cube_simulation(cloud, spec.method, "hypoelastic", start));
      run.row.material = "hypoelastic";
    } catch (const InputError&) {
      run.row.status = "skipped";
      return run;
    }

  std::optional<StressRecovery<3>> recovery;
  const bool rates = material_registry().find(run.row.material).traits.kind == MaterialKind::rate;
  if (spec.recover && !rates) recovery.emplace(*simulation);
  const auto take = [&](CubeErrorSums& sums) {
    sums.add(
        cloud, start + simulation->time(), [&](std::size_t i) { return simulation->velocity(i); },
        [&](std::size_t i) {
          return rates ? simulation->cauchy_stress(i)(0, 0) : simulation->first_piola_kirchhoff(i)(0, 0);
        },
        recovery ? recovery->first_piola_kirchhoff() : std::vector<Mat<3>>());
  };
  CubeErrorSums snapshot, over_quarter;
  double looking = 0;
  simulation->observe(quarter / instants, [&](double t) {
    if (start + t <= 0.5 * quarter / instants) return;  // the given state, and what rate forms do before it
    const auto begin = Clock::now();
    take(over_quarter);
    looking += seconds_since(begin);
  });
  const RunOptions options{.max_step = step_of(spec.intervals)};
  RunResult result = simulation->run(SwingingCube::snapshot() - start, options);
  if (result.status == Status::ok) {
    take(snapshot);
    const RunResult first = result;
    result = simulation->run(quarter - SwingingCube::snapshot(), options);
    result.steps += first.steps;
    result.loop_seconds += first.loop_seconds;
  }
  result.loop_seconds -= looking;
  set_run(run.row, *simulation, result);
  if (result.status != Status::ok) {
    run.why = result.breakdown ? result.breakdown->what : to_string(result.status);
    return run;
  }
  run.why.clear();
  run.snapshot = snapshot.errors();
  run.quarter = over_quarter.errors();
  return run;
}

CubeRun run_cube_fem(const CubeSpec& spec, int threads) {
  const int intervals = spec.intervals;
  const Cloud<3> cloud = swinging_cube_cloud(intervals, spec.jitter, spec.seed);
  CubeRun run;
  run.row = row_of(cloud, spec.jitter, threads);
  run.row.formulation = "fem_hexahedra";
  const auto begin = Clock::now();
  HexahedralFem fem(cloud.X, {intervals, intervals, intervals}, SwingingCube::material());
  for (int axis = 0; axis < 3; ++axis) {
    fem.fix([axis](const Vec<3>& X) { return X[axis] == 0; }, axis);
    for (int tangential = 0; tangential < 3; ++tangential)
      if (tangential != axis) fem.fix([axis](const Vec<3>& X) { return X[axis] == 1; }, tangential);
  }
  double t = spec.undeformed ? -SwingingCube::quarter_period() : 0;
  fem.set_displacement([t](const Vec<3>& X) { return SwingingCube::displacement(X, t); });
  fem.set_velocity([t](const Vec<3>& X) { return SwingingCube::velocity(X, t); });
  std::optional<PatchFit<3>> fit;
  if (spec.recover) {
    const auto one_group = [](std::vector<Vec<3>> X) {
      const std::size_t n = X.size();
      return PatchPoints<3>{std::move(X), std::vector<Index>(n, 0)};
    };
    fit.emplace(one_group(cloud.X), one_group(fem.element_centres()),
                StressRecovery<3>::default_support_dx * cloud.dx);
  }
  run.row.setup_s = seconds_since(begin);
  run.row.loop_s = 0;
  run.row.steps = 0;
  const auto advance = [&](double to, CubeErrorSums& sums) {
    const auto start = Clock::now();
    *run.row.steps += fem.run(to - t, step_of(intervals));
    *run.row.loop_s += seconds_since(start);
    t = to;
    const std::vector<Mat<3>> stress = fem.nodal_stress();
    sums.add(
        cloud, t, [&](std::size_t i) { return fem.velocity(i); },
        [&](std::size_t i) { return stress[i](0, 0); },
        fit ? (*fit)(fem.element_stress()) : std::vector<Mat<3>>());
  };
  CubeErrorSums snapshot, over_quarter;
  for (int k = 1; k <= instants; ++k) {
    const double to = SwingingCube::quarter_period() * k / instants;
    if (t < SwingingCube::snapshot() && to > SwingingCube::snapshot())
      advance(SwingingCube::snapshot(), snapshot);
    advance(to, over_quarter);
  }
  run.row.time = t;
  run.snapshot = snapshot.errors();
  run.quarter = over_quarter.errors();
  return run;
}

std::optional<double> initial_acceleration_error(const CubeSpec& spec) {
  const Cloud<3> cloud = swinging_cube_cloud(spec.intervals, spec.jitter, spec.seed);
  Simulation<3> simulation = cube_simulation(cloud, spec.method, "linear_elastic", 0);
  // From rest one short step of leapfrog gives the mean of the accelerations at its ends: those at t = 0 up
  // to (omega dt)^2, 1e-8.
  const double dt = 1e-4 / SwingingCube::angular_frequency();
  if (simulation.run(dt, {.max_step = dt}).status != Status::ok) return {};
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec<3> exact = SwingingCube::acceleration(cloud.X[i], 0);
    difference += cloud.V[i] * (simulation.velocity(i) / dt - exact).squaredNorm();
    size += cloud.V[i] * exact.squaredNorm();
  }
  return std::sqrt(difference / size);
}

}  // namespace taut::bench
