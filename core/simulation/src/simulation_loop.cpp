#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <taut/base/powers.hpp>
#include <taut/integrators/relax.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

namespace {

// Begins with another integrator, at the present time: with the constraints and all rates there. Where
// something throws the state is as it was.
template <int D>
void begin(SimulationImpl<D>& s, const std::string& integrator) {
  s.look();
  s.integrator.reset();
  s.clock = {.start = s.time};
  const Field u = s.particles.u, v = s.particles.v;
  try {
    s.formulation->constrain_positions(s.time);
    s.formulation->constrain_velocities(s.time);
    s.formulation->update(s.time);
  } catch (...) {
    std::copy(u.flat().begin(), u.flat().end(), s.particles.u.flat().begin());
    std::copy(v.flat().begin(), v.flat().end(), s.particles.v.flat().begin());
    throw;
  }
  s.integrator = make_integrator(integrator);
  s.integrator_name = integrator;
}

// A step of the integrator. One that throws leaves a state that nobody can go on from.
template <int D>
void step(SimulationImpl<D>& s, double dt) {
  s.step_begins();
  try {
    s.integrator->step(*s.formulation, s.clock.now(), dt);
  } catch (...) {
    s.integrator.reset();
    throw;
  }
  s.clock.advance(dt);
}

/// What both loops do around a step: count, keep time, look for breakdowns.
template <int D>
class Loop {
 public:
  Loop(SimulationImpl<D>& simulation, bool undamped) : s_(simulation), watch_(simulation, undamped) {}

  RunResult result;

  /// Ends the run: no particle is to blame.
  void give_up(const char* what) {
    result.status = Status::broke;
    result.breakdown = Breakdown{what, -1, {}, {}, s_.time, result.steps};
  }
  /// Whether the formulation still holds; else the result says how it broke.
  bool intact();
  /// Counts a step that ended at time t.
  void stepped(double t) {
    s_.time = t;
    s_.step_ends();
    if (++result.steps % inspect_every == 0) s_.formulation->inspect();
    watch_.stepped(result.steps);
  }
  /// Asks every now and then whether to go on.
  bool stopped(const Progress& progress, double fraction) const {
    return progress && result.steps % inspect_every == 0 && !progress(result.steps, s_.time, fraction);
  }
  /// `at_rest`: the run was on its way to a state of rest, and that alone counts.
  RunResult finish(bool at_rest);

 private:
  // Steps between the checks that cost a sweep over the particles.
  static constexpr std::int64_t inspect_every = 32;

  SimulationImpl<D>& s_;
  HealthWatch<D> watch_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

template <int D>
bool Loop<D>::intact() {
  const auto& failure = s_.formulation->failure();
  if (!failure) return true;
  const auto at = static_cast<std::size_t>(failure->particle);
  Breakdown b;
  b.what = failure->what;
  b.particle = s_.particles.id[at];
  for (int d = 0; d < D; ++d) {
    const auto axis = static_cast<std::size_t>(d);
    const double X = s_.particles.X.component(d)[at], origin = s_.particles.origin[d];
    b.X[axis] = origin + X;
    b.x[axis] = origin + (X + s_.particles.u.component(d)[at]);
  }
  b.time = s_.time;
  b.step = result.steps;
  result.status = Status::broke;
  result.breakdown = b;
  return false;
}

template <int D>
RunResult Loop<D>::finish(bool at_rest) {
  // Runs that end before the first such check have one as well: a step knows waves, not how fast a body
  // moves.
  if (intact() && result.steps > 0 && result.steps < inspect_every) s_.formulation->inspect();
  const bool broke = !intact();
  result.time = s_.time;
  result.rebuilds = s_.formulation->rebuilds();
  result.loop_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  s_.health = result.health = watch_.finish(at_rest, broke);
  return result;
}

// Who watches may look at velocities, now or after an exception of its own.
template <int D, class Call>
auto with_velocities(SimulationImpl<D>& s, Call&& call) {
  try {
    return call();
  } catch (...) {
    s.look();
    throw;
  }
}

// The ramp of a relaxation, from the part of the loads that acts already.
template <int D>
class Ramp {
 public:
  Ramp(SimulationImpl<D>& s, double duration)
      : s_(s), start_(s.time), duration_(s.load_level < 1 ? duration : 0), from_(s.load_level) {
    if (duration_ > 0) s.loads.set_ramp([this](double t) { return level(t); });
  }
  ~Ramp() {
    s_.load_level = level(s_.time);
    s_.loads.set_ramp({});
    s_.integrator.reset();  // whose rates were those of the ramp
  }
  /// When all loads act [s].
  double end() const { return start_ + duration_; }
  Ramp(const Ramp&) = delete;
  Ramp& operator=(const Ramp&) = delete;

 private:
  double level(double t) const {
    if (!(duration_ > 0)) return 1;
    const double q = std::clamp((t - start_) / duration_, 0.0, 1.0);
    return from_ + (1 - from_) * (q * q * (3 - 2 * q));
  }

  SimulationImpl<D>& s_;
  double start_, duration_, from_;
};

template <int D>
void notify(SimulationImpl<D>& s) {
  for (auto& o : s.observers)
    if (s.time >= o.next * (1 - 1e-12)) {
      s.look();  // before observers may read from many threads
      o.f(s.time);
      o.next = o.interval > 0 ? o.interval * (std::floor(s.time / o.interval * (1 + 1e-12)) + 1) : s.time;
    }
}

// Whether displacements and velocities are small enough to be computed with.
template <int D>
bool has_numbers(const Particles<D>& p) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.n); ++i)
    if (!std::isfinite(p.u.template vec<D>(i).squaredNorm() + p.v.template vec<D>(i).squaredNorm()))
      return false;
  return true;
}

// No force is applied and no prescribed displacement changes, now or later.
template <int D>
bool is_left_alone(const SimulationImpl<D>& s, const std::vector<double>& times) {
  for (const double t : times)
    if (s.loads.norm(t, s.particles.m) != 0) return false;
  return !s.constraints.move_later(s.time, times, s.particles.X);
}

// Out-of-balance force [N] that rounding of the state (displacements, or positions where stresses follow from
// rates) can make: rounded strains, times the modulus, on the faces of a cell, for all particles.
template <int D>
double force_of_round_off(const SimulationImpl<D>& s) {
  double modulus = 0, farthest = 0;
  for (const auto& material : s.particles.materials)
    modulus = std::max(modulus, material->density() * material->wave_speed() * material->wave_speed());
  const bool rates = !s.formulation->others().empty();
  for (int d = 0; d < D; ++d)
    for (Index i = 0; i < s.particles.n; ++i)
      farthest = std::max(
          farthest, std::abs(s.particles.u.component(d)[i] + (rates ? s.particles.X.component(d)[i] : 0)));
  constexpr double roundings = 8;
  return roundings * std::numeric_limits<double>::epsilon() * std::sqrt(static_cast<double>(s.particles.n)) *
         modulus * farthest * int_power(s.particles.dx, D - 2);
}

}  // namespace

bool advances(double end, double step) { return end - step < end; }

template <int D>
std::vector<double> relaxation_times(const SimulationImpl<D>& s, const RelaxOptions& options) {
  const double step = options.cfl * stable_step(leapfrog_limits, s.formulation->fastest());
  std::vector<double> times{s.time, s.time + options.ramp_time, s.time + options.free_time};
  for (double steps = 1; steps <= static_cast<double>(options.max_steps) && steps <= 1e9; steps *= 10)
    times.push_back(s.time + steps * step);
  return times;
}

const char* to_string(Status status) {
  switch (status) {
    case Status::ok:
      return "ok";
    case Status::broke:
      return "broke";
    case Status::not_converged:
      return "not_converged";
  }
  return "";
}

template <int D>
RunResult integrate(SimulationImpl<D>& s, double duration, const RunOptions& options) {
  const double end = s.time + duration;
  if (duration > 0) s.load_level = 1;
  if (!s.integrator || s.integrator_name != options.integrator) begin(s, options.integrator);
  Loop<D> loop(s, true);
  with_velocities(s, [&] { notify(s); });
  while (s.time < end && loop.intact()) {
    double bound = options.cfl * stable_step(s.integrator->limits(), s.formulation->fastest());
    if (options.max_step > 0) bound = std::min(bound, options.max_step);
    double dt = s.step_control.next(bound);
    if (!advances(end, dt)) {
      loop.give_up(std::isfinite(dt) && has_numbers(s.particles) ? "step too small to advance time"
                                                                 : "not a number");
      break;
    }
    // No sliver of a step that rounding has left, nor one for its sake that is not as long as the others.
    const double left = end - s.clock.now(), sliver = 1e-6 * dt;
    const bool last = dt >= left - sliver;
    const bool cut = dt > left + sliver;
    if (cut) dt = left;
    step(s, dt);
    if (cut) s.clock = {.start = end};
    loop.stepped(last ? end : s.clock.now());
    const bool go_on = with_velocities(s, [&] {
      notify(s);
      return !options.progress || options.progress(loop.result.steps, s.time, 1 - (end - s.time) / duration);
    });
    if (!go_on) break;
  }
  s.look();
  return loop.finish(false);
}

template <int D>
RunResult find_equilibrium(SimulationImpl<D>& s, const RelaxOptions& options) {
  const double start = s.time;
  // Asked before anything changes, for histories may throw. Where nothing is applied and nothing will be,
  // round-off must not be compared with round-off.
  const bool left_alone = is_left_alone(s, relaxation_times(s, options));
  const Ramp<D> ramp(s, options.ramp_time);
  begin(s, "leapfrog");
  Loop<D> loop(s, false);
  RunResult& result = loop.result;
  result.status = Status::not_converged;
  bool stopped = false;
  while (!stopped && s.time - start < options.free_time && result.steps < options.max_steps &&
         loop.intact()) {
    step(s, s.step_control.next(options.cfl * stable_step(leapfrog_limits, s.formulation->fastest())));
    loop.stepped(s.clock.now());
    stopped = with_velocities(s, [&] { return loop.stopped(options.progress, 0); });
  }
  s.look();
  s.integrator.reset();
  Relaxation relaxation(*s.formulation);
  double largest = 0;
  const double round_off = left_alone ? force_of_round_off(s) : 0;
  // A passing coincidence of small forces is no equilibrium: they must stay small.
  constexpr int in_a_row = 20;
  int converged = 0;
  while (!stopped && result.steps < options.max_steps && loop.intact()) {
    const double dt = options.cfl * stable_step(leapfrog_limits, s.formulation->fastest());
    if (!(dt > 0) || !std::isfinite(dt)) {
      loop.give_up(dt == 0 && has_numbers(s.particles) ? "step too small to advance time" : "not a number");
      break;
    }
    s.step_begins();
    relaxation.step(s.time, dt);
    loop.stepped(s.time + dt);
    largest = std::max(largest, relaxation.force_norm());
    const double applied = s.loads.norm(s.time, s.particles.m);
    const double scale = applied > 0 ? applied : largest;
    result.residual = scale > 0 ? relaxation.force_norm() / scale : 0;
    const double progress = std::log(std::max(result.residual, 1e-300)) / std::log(options.tolerance);
    stopped = loop.stopped(options.progress, std::min(1.0, progress));
    result.remaining_motion = relaxation.remaining_motion();
    // Nothing has moved yet, but will.
    const bool waits = scale == 0 && !left_alone;
    const bool small = !waits && s.time >= ramp.end() &&
                       ((left_alone && relaxation.force_norm() <= round_off) ||
                        (result.residual <= options.tolerance &&
                         (result.remaining_motion <= RelaxOptions::still_moving || result.residual == 0)));
    converged = small ? converged + 1 : 0;
    if (converged == in_a_row) {
      result.status = Status::ok;
      break;
    }
  }
  return loop.finish(true);
}

#define TAUT_INSTANTIATE(D)                                                                        \
  template std::vector<double> relaxation_times<D>(const SimulationImpl<D>&, const RelaxOptions&); \
  template RunResult integrate<D>(SimulationImpl<D>&, double, const RunOptions&);                  \
  template RunResult find_equilibrium<D>(SimulationImpl<D>&, const RelaxOptions&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
