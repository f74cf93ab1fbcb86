#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/analytic.hpp>
#include <lib/build.hpp>
#include <lib/case.hpp>
#include <lib/files.hpp>
#include <lib/measure.hpp>
#include <lib/reference.hpp>
#include <lib/scene_keys.hpp>
#include <limits>
#include <taut/geometry/local_origin.hpp>
#include <taut/output/derived.hpp>

namespace taut::bench {
namespace {

/// Reads the present value of a probe.
template <int D>
class Sampler {
 public:
  Sampler(const Simulation<D>& simulation, const ProbeSpec& probe)
      : simulation_(&simulation), probe_(&probe) {
    if (probe.at.empty()) return;
    for (int d = 0; d < D; ++d) at_[d] = probe.at[static_cast<std::size_t>(d)];
    // Particles equally near count equally, so that a point on a symmetry line sees a symmetric value.
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < simulation.size(); ++i)
      nearest = std::min(nearest, (simulation.reference_position(i) - at_).norm());
    const double slack = 1e-6 * simulation.dx() + coordinate_rounding(at_.norm());
    for (std::size_t i = 0; i < simulation.size(); ++i)
      if ((simulation.reference_position(i) - at_).norm() <= nearest + slack) near_.push_back(i);
  }

  const Vec<D>& at() const { return at_; }
  /// One of the particles that are nearest to it.
  std::size_t nearest() const { return near_.front(); }

  double operator()() const {
    const std::string& type = probe_->type;
    if (type == "displacement") return simulation_->displacement_at(at_)[probe_->row];
    if (type == "velocity") return mean([&](std::size_t i) { return simulation_->velocity(i)[probe_->row]; });
    if (type == "cauchy_stress")
      return mean_of_stress([&](const Mat<3>& sigma) { return sigma(probe_->row, probe_->column); });
    if (type == "von_mises") return mean_of_stress(von_mises);
    if (type == "pressure") return mean_of_stress(pressure);
    if (type == "linear_momentum") return simulation_->linear_momentum()[probe_->row];
    return type == "kinetic_energy" ? simulation_->kinetic_energy() : simulation_->strain_energy();
  }

 private:
  template <class F>
  double mean(F&& value) const {
    double sum = 0;
    for (const std::size_t i : near_) sum += value(i);
    return sum / static_cast<double>(near_.size());
  }

  template <class F>
  double mean_of_stress(F&& value) const {
    return mean([&](std::size_t i) { return value(simulation_->full_cauchy_stress(i)); });
  }

  const Simulation<D>* simulation_;
  const ProbeSpec* probe_;
  Vec<D> at_ = Vec<D>::Zero();
  std::vector<std::size_t> near_;
};

double field_value(const Mat<3>& sigma, const std::string& field) {
  if (field == "cauchy_xx") return sigma(0, 0);
  if (field == "cauchy_yy") return sigma(1, 1);
  if (field == "cauchy_zz") return sigma(2, 2);
  if (field == "cauchy_xy") return sigma(0, 1);
  return von_mises(sigma);
}

template <int D>
Snapshot snapshot(const Simulation<D>& simulation) {
  Snapshot shot;
  shot.spacing = simulation.dx();
  for (std::size_t i = 0; i < simulation.size(); ++i) {
    std::array<double, 3> x{};
    for (int d = 0; d < D; ++d) x[static_cast<std::size_t>(d)] = simulation.position(i)[d];
    shot.x.push_back(x);
    const Mat<3> sigma = simulation.full_cauchy_stress(i);
    for (const std::string& field : picture_fields()) shot.fields[field].push_back(field_value(sigma, field));
  }
  return shot;
}

std::string point_text(const std::array<double, 3>& x, int dimension) {
  std::string text;
  for (int d = 0; d < dimension; ++d)
    text += fmt::format("{}{:.4g}", d ? ", " : "", x[static_cast<std::size_t>(d)] * 1e3);
  return '(' + text + ')';
}

RelaxOptions relax_options(const SolveSpec& spec, const Progress& progress) {
  RelaxOptions options;
  options.tolerance = spec.tolerance;
  options.ramp_time = spec.ramp_time;
  options.free_time = spec.free_time;
  options.max_steps = spec.max_steps;
  options.cfl = spec.cfl;
  options.progress = progress;
  return options;
}

RunOptions run_options(const SolveSpec& spec, const Progress& progress) {
  RunOptions options;
  options.integrator = spec.integrator;
  options.cfl = spec.cfl;
  options.max_step = spec.max_step;
  options.progress = progress;
  return options;
}

template <int D>
RunResult solve(Simulation<D>& simulation, const SolveSpec& spec, const Progress& progress) {
  if (spec.mode == "relax") return simulation.relax(relax_options(spec, progress));
  return simulation.run(spec.duration, run_options(spec, progress));
}

/// Which condition of equilibrium is not met.
std::string unmet(const RunResult& run, double tolerance) {
  if (run.residual > tolerance)
    return fmt::format("out-of-balance force {:.2g} of the load, wanted {:.2g}", run.residual, tolerance);
  if (run.remaining_motion > RelaxOptions::still_moving)
    return fmt::format(
        "forces balance to {:.2g} of the load, but the body still moves: {:.2g} of its way is left, wanted "
        "{:.2g}",
        run.residual, run.remaining_motion, RelaxOptions::still_moving);
  return "forces balance and the body is at rest, but not for long enough";
}

/// Numbers that a table can hold.
std::optional<double> finite(std::optional<double> value) {
  if (value && !std::isfinite(*value)) value.reset();
  return value;
}

void record(CaseResult& result, const RunResult& run, const RunSpec& spec, int dimension) {
  result.steps = run.steps;
  result.time = run.time;
  result.loop_s = run.loop_seconds;
  result.health = run.health;
  if (run.status == Status::ok) return;
  result.broke = true;
  if (run.breakdown) {
    const Breakdown& b = *run.breakdown;
    result.broke_time = b.time;
    result.what = b.what;
    if (b.particle >= 0)
      result.where = fmt::format("particle {}, from {} to {} mm", b.particle, point_text(b.X, dimension),
                                 point_text(b.x, dimension));
    return;
  }
  result.broke_time = run.time;
  result.what =
      fmt::format("no equilibrium within {} steps: {}", run.steps, unmet(run, spec.solve.tolerance));
}

void divide(Measured& m, const Measured& by) {
  if (by.value && *by.value != 0) {
    *m.value /= *by.value;
    return;
  }
  m.value.reset();
  m.why_none = fmt::format("'{}', which divides it, is {}", by.probe->name, by.value ? "zero" : "unknown");
}

template <int D>
CaseResult run(const Scene& scene, const RunSpec& spec, const SweepPoint& point, const CaseOptions& options) {
  CaseResult result;
  result.scene = &scene;
  result.run = &spec;
  result.point = point;
  result.material = material_of(scene, spec, point).model;
  result.dx = lattice_of(spec, point).dx;

  Simulation<D> simulation = build_simulation<D>(scene, spec, point);
  std::vector<Sampler<D>> samplers;
  for (const ProbeSpec& probe : scene.probes)
    if (wanted(probe, spec, point)) {
      result.measured.push_back({&probe, {}, reference_value(scene, spec, point, probe), {}, {}, {}});
      samplers.emplace_back(simulation, probe);
    }
  const bool dynamic = spec.solve.mode == "dynamic";
  if (dynamic)
    simulation.observe(spec.solve.duration / spec.solve.samples, [&](double t) {
      for (std::size_t i = 0; i < samplers.size(); ++i) {
        result.measured[i].history.t.push_back(t);
        result.measured[i].history.value.push_back(samplers[i]());
      }
    });
  record(result, solve(simulation, spec.solve, options.progress), spec, D);
  result.particles = static_cast<std::int64_t>(simulation.size());
  result.pairs = simulation.pairs();
  result.bytes = static_cast<double>(simulation.bytes());
  result.setup_s = simulation.setup_seconds();

  for (std::size_t i = 0; i < samplers.size(); ++i) {
    Measured& m = result.measured[i];
    if (m.probe->reference && !m.probe->reference->analytic.empty())
      if (const auto curve = analytic(scene, spec, point, *m.probe).curve) {
        m.exact.t = m.history.t;
        for (const double t : m.exact.t) m.exact.value.push_back(curve(t));
        if (m.probe->measure == "curve_error") m.reference.reset();
      }
    if (result.broke) continue;
    m.value = m.probe->measure == "final" ? samplers[i]() : measure(*m.probe, m.history, m.exact);
    if (!m.value) m.why_none = "its window holds no sample, or nothing but zeros";
  }
  for (Measured& m : result.measured)
    if (m.value && !m.probe->over.empty())
      for (const Measured& other : result.measured)
        if (other.probe->name == m.probe->over) divide(m, other);
  for (Measured& m : result.measured)
    if (m.value && !std::isfinite(*m.value)) {
      m.value.reset();
      m.why_none = "its value is no finite number";
    }

  if (options.keep_snapshot) result.snapshot = snapshot(simulation);
  if (options.measured) options.measured(result);
  if (!options.field_file.empty()) try {
      write_vtkhdf(options.field_file.string(), simulation);
    } catch (const Error& error) {
      result.field_error = error.what();
    }
  return result;
}

/// Whether a probe lies in the body, or next to it. Of a shape's lattice the shape says so, of layers beyond
/// it their particles, and of a cloud its particles alone: then as far away as pairs reach, and no less than
/// the spacing, also where it is wider than elsewhere, so that no point of the surface is taken for one
/// outside.
template <int D>
bool is_placed(const Scene& scene, const RunSpec& spec, const Simulation<D>& simulation,
               const Sampler<D>& sampler) {
  const double dx = simulation.dx();
  const double distance = (simulation.reference_position(sampler.nearest()) - sampler.at()).norm();
  if (scene.geometry.type != "csv")
    return distance <= 0.5 * dx || (distance <= 2.5 * dx && is_near_shape<D>(scene, sampler.at(), 0.5 * dx));
  return distance <= std::max(dx, 0.6 * spec.method.support_dx * dx);
}

/// Reads a probe before anything moves.
template <int D>
void check_probe(const Scene& scene, const RunSpec& spec, const Simulation<D>& simulation,
                 const ProbeSpec& probe) {
  const Sampler<D> sampler(simulation, probe);
  if (!probe.at.empty() && !is_placed(scene, spec, simulation, sampler)) {
    const Vec<D> nearest = simulation.reference_position(sampler.nearest());
    const auto text = [](const Vec<D>& X) {
      return fmt::format("({:g})", fmt::join(X.data(), X.data() + D, ", "));
    };
    fail(probe.at_place,
         fmt::format(
             "[probe] at: '{}' at {} m lies outside of the body, {:.3g} m from its nearest particle at {} m "
             "in the run '{}'; give a point of the body in its reference configuration",
             probe.name, text(sampler.at()), (nearest - sampler.at()).norm(), text(nearest), spec.label));
  }
  try {
    sampler();
  } catch (const InputError& error) {
    fail(probe.place, fmt::format("[probe] '{}' in the run '{}': {}", probe.name, spec.label, error.what()));
  }
}

template <int D>
void check(const Scene& scene, const RunSpec& spec, const SweepPoint& point) {
  Simulation<D> simulation = build_simulation<D>(scene, spec, point);
  try {
    if (spec.solve.mode == "relax")
      simulation.check_relax(relax_options(spec.solve, {}));
    else
      simulation.check_run(spec.solve.duration, run_options(spec.solve, {}));
  } catch (const InputError& error) {
    fail(spec.place, std::string("[run] '") + spec.label + "': " + error.what());
  }
  const std::vector<SweepPoint> points = scene.points();
  for (const ProbeSpec& probe : scene.probes)
    if (std::any_of(points.begin(), points.end(),
                    [&](const SweepPoint& p) { return wanted(spec, p) && wanted(probe, spec, p); }))
      check_probe<D>(scene, spec, simulation, probe);
}

}  // namespace

void check_case(const Scene& scene, const RunSpec& spec, const SweepPoint& point) {
  if (scene.dimension == 1) return check<1>(scene, spec, point);
  if (scene.dimension == 2) return check<2>(scene, spec, point);
  return check<3>(scene, spec, point);
}

CaseResult run_case(const Scene& scene, const RunSpec& spec, const SweepPoint& point,
                    const CaseOptions& options) {
  if (scene.dimension == 1) return run<1>(scene, spec, point, options);
  if (scene.dimension == 2) return run<2>(scene, spec, point, options);
  return run<3>(scene, spec, point, options);
}

std::string case_name(const Scene& scene, const RunSpec& run, const SweepPoint& point) {
  std::string name = scene.name + ' ' + run.label;
  for (const auto& [key, value] : point) name += ' ' + key + ' ' + snake_number(value);
  return file_name_of(name);
}

std::string describe(const SweepPoint& point) {
  std::string text;
  for (const auto& [name, value] : point) {
    text += text.empty() ? "" : ", ";
    if (name == "load")
      text += fmt::format("load {:.12g} N", value);
    else if (name == "nu")
      text += fmt::format("ν {:.12g}", value);
    else if (name == "dx")
      text += fmt::format("dx {:.12g} mm", value * 1e3);
    else
      text += fmt::format("region density {:.12g} kg/m³", value);
  }
  return text;
}

std::vector<Row> CaseResult::rows(int threads) const {
  Row common;
  common.scene = scene->name;
  set_method(common, run->method);
  common.material = material;
  if (dx > 0) common.dx = dx;
  common.integrator = run->solve.mode == "relax" ? "relax" : run->solve.integrator;
  common.threads = threads;
  common.label = run->label;
  std::string suffix;
  for (const auto& [name, value] : point)
    if (name != "dx") {  // that has a column
      suffix += '_' + name + '_' + snake_number(value);
      common.swept[name] = value;
    }
  Row taken = common;
  taken.particles = particles;
  taken.pairs = pairs;
  taken.steps = steps;
  taken.time = time;
  taken.setup_s = setup_s;
  taken.loop_s = loop_s;
  if (loop_s > 0) taken.particle_steps_per_s = rate();
  if (particles > 0) taken.bytes_per_particle = bytes / static_cast<double>(particles);

  std::vector<Row> rows;
  for (const ProbeSpec& probe : scene->probes) {
    const auto found =
        std::find_if(measured.begin(), measured.end(), [&](const Measured& m) { return m.probe == &probe; });
    Row row = found == measured.end() ? common : taken;
    row.quantity = probe.name + suffix;
    row.unit = probe.unit();
    if (found == measured.end()) {
      row.status = "skipped";
    } else if (broke) {
      row.status = "broke";
    } else {
      if (suspect()) row.status = "suspect";
      row.value = finite(found->value);
      row.reference = finite(found->reference);
      if (probe.measure == "curve_error") row.error = row.value;
      if (row.value && row.reference)
        row.error = finite(error_of(*row.value, *row.reference, probe.measure == "arrival_time"));
      if (!row.value) row.status = "suspect";
    }
    rows.push_back(std::move(row));
  }
  if (broke && !measured.empty()) {
    Row row = taken;
    row.quantity = "breakdown_time" + suffix;
    row.unit = "s";
    row.value = finite(broke_time);
    row.status = row.value ? "ok" : "suspect";
    rows.push_back(std::move(row));
  }
  for (const HealthMeasure& m : health.measures) {
    Row row = taken;
    row.quantity = m.name + suffix;
    row.unit = "1";
    row.value = finite(m.value);
    if (m.flagged() || !row.value) row.status = "suspect";
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace taut::bench
