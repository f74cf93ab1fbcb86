#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/analytic.hpp>
#include <lib/build.hpp>
#include <lib/case.hpp>
#include <lib/files.hpp>
#include <lib/measure.hpp>
#include <lib/reference.hpp>

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
    double nearest = std::numeric_limits<double>::max();
    for (std::size_t i = 0; i < simulation.size(); ++i)
      nearest = std::min(nearest, (simulation.reference_position(i) - at_).norm());
    const double slack = 1e-6 * std::pow(simulation.mass(0), 1.0 / D);
    for (std::size_t i = 0; i < simulation.size(); ++i)
      if ((simulation.reference_position(i) - at_).norm() <= nearest + slack) near_.push_back(i);
  }

  double operator()() const {
    const std::string& type = probe_->type;
    if (type == "displacement") return simulation_->displacement_at(at_)[probe_->row];
    if (type == "velocity") return mean([&](std::size_t i) { return simulation_->velocity(i)[probe_->row]; });
    if (type == "cauchy_stress")
      return mean([&](std::size_t i) { return simulation_->cauchy_stress(i)(probe_->row, probe_->column); });
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

  const Simulation<D>* simulation_;
  const ProbeSpec* probe_;
  Vec<D> at_ = Vec<D>::Zero();
  std::vector<std::size_t> near_;
};

template <int D>
double field_value(const Mat<D>& sigma, const std::string& field) {
  if (field == "cauchy_xx") return sigma(0, 0);
  if (field == "cauchy_yy") return D > 1 ? sigma(D > 1, D > 1) : 0;
  if (field == "cauchy_xy") return D > 1 ? sigma(0, D > 1) : 0;
  Eigen::Matrix3d s = Eigen::Matrix3d::Zero();
  s.template topLeftCorner<D, D>() = sigma;
  s -= s.trace() / 3 * Eigen::Matrix3d::Identity();
  return std::sqrt(1.5 * s.squaredNorm());
}

template <int D>
Snapshot snapshot(const Simulation<D>& simulation) {
  Snapshot shot;
  for (std::size_t i = 0; i < simulation.size(); ++i) {
    std::array<double, 3> x{};
    for (int d = 0; d < D; ++d) x[static_cast<std::size_t>(d)] = simulation.position(i)[d];
    shot.x.push_back(x);
    const Mat<D> sigma = simulation.cauchy_stress(i);
    for (const char* field : {"von_mises", "cauchy_xx", "cauchy_yy", "cauchy_xy"})
      shot.fields[field].push_back(field_value<D>(sigma, field));
  }
  return shot;
}

std::string point_text(const std::array<double, 3>& x, int dimension) {
  std::string text;
  for (int d = 0; d < dimension; ++d)
    text += fmt::format("{}{:.4g}", d ? ", " : "", x[static_cast<std::size_t>(d)] * 1e3);
  return '(' + text + ')';
}

template <int D>
RunResult solve(Simulation<D>& simulation, const SolveSpec& spec, const Progress& progress) {
  if (spec.mode == "relax") {
    RelaxOptions options;
    options.tolerance = spec.tolerance;
    options.ramp_time = spec.ramp_time;
    options.free_time = spec.free_time;
    options.max_steps = spec.max_steps;
    options.cfl = spec.cfl;
    options.progress = progress;
    return simulation.relax(options);
  }
  RunOptions options;
  options.integrator = spec.integrator;
  options.cfl = spec.cfl;
  options.max_step = spec.max_step;
  options.progress = progress;
  return simulation.run(spec.duration, options);
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
  if (run.status == Status::ok) return;
  result.broke = true;
  if (run.breakdown) {
    const Breakdown& b = *run.breakdown;
    result.broke_time = b.time;
    result.what = b.what;
    result.where = fmt::format("particle {}, from {} to {} mm", b.particle, point_text(b.X, dimension),
                               point_text(b.x, dimension));
    return;
  }
  result.broke_time = run.time;
  result.what =
      fmt::format("no equilibrium within {} steps: out-of-balance force {:.2g} of the load, wanted {:.2g}",
                  run.steps, run.residual, spec.solve.tolerance);
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
      result.measured.push_back({&probe, {}, reference_value(scene, spec, point, probe), {}, {}});
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
    if (!result.broke)
      m.value = m.probe->measure == "final" ? samplers[i]() : measure(*m.probe, m.history, m.exact);
  }
  for (Measured& m : result.measured)
    if (m.value && !m.probe->over.empty())
      for (const Measured& other : result.measured)
        if (other.probe->name == m.probe->over && other.value) *m.value /= *other.value;
  for (Measured& m : result.measured) m.value = finite(m.value);

  if (options.keep_snapshot) result.snapshot = snapshot(simulation);
  if (options.measured) options.measured(result);
  if (!options.field_file.empty()) try {
      write_vtkhdf(options.field_file.string(), simulation);
    } catch (const Error& error) {
      result.field_error = error.what();
    }
  return result;
}

template <int D>
void check(const Scene& scene, const RunSpec& spec, const SweepPoint& point) {
  Simulation<D> simulation = build_simulation<D>(scene, spec, point);
  try {
    simulation.prepare();
  } catch (const InputError& error) {
    fail(spec.place, std::string("[run] '") + spec.label + "': " + error.what());
  }
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
  return rows;
}

}  // namespace taut::bench
