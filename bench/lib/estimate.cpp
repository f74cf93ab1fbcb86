#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <lib/build.hpp>
#include <lib/case.hpp>
#include <lib/csv_table.hpp>
#include <lib/estimate.hpp>
#include <lib/names.hpp>
#include <lib/slowest_mode.hpp>
#include <limits>
#include <taut/operators/registry.hpp>

namespace taut::bench {
namespace {

/// Measured on bodies of 39304 to 160801 particles: largest resident size of a whole job over particles, of
/// lattices and jittered ones (R = 1.5 dx, and 2.4 dx for the part of the pairs), processor seconds of a job
/// without its steps; and nanoseconds a particle-step and thread, from bench/PERFORMANCE.md and, for rates,
/// from small bodies.
struct Cost {
  double bytes, bytes_a_pair;      // memory of a particle: bytes + bytes_a_pair · pairs
  double step_ns, step_ns_a_pair;  // a step of a particle likewise
  double setup_us;
};

/// The program itself, its libraries included.
constexpr double program_bytes = 15e6;

Cost cost_of(const Method& method, int dimension, bool regular, bool plain_box) {
  const bool solid = dimension == 3;
  const FormulationTraits& traits = formulation_traits(method.formulation);
  if (!traits.pairs) return {solid ? 500.0 : 370.0, 0, solid ? 40.0 : 20.0, 0, solid ? 3.0 : 2.0};
  if (traits.reference == Reference::updated)
    return {solid ? 330.0 : 320.0, 6, has_parameter(method.formulation, "artificial_stress") ? 150.0 : 60.0,
            3.5, solid ? 4.0 : 2.0};
  const double base = solid ? 600 : 370;
  if (traits.stress == StressAt::bonds)  // pairs with a stress of their own
    return {base, regular ? 0.0 : 33.0, 60, 8, solid ? 18.0 : 8.0};
  const OperatorTraits& operators = operator_traits(method.operators);
  const bool compatible = operators.areas && operators.adjoint;
  if (regular && (plain_box || !compatible)) return {solid ? 540.0 : 360.0, 0, 7, 0.83, solid ? 8.0 : 3.0};
  if (compatible) return {base, 62, 20, 4, solid ? 19.0 : 8.0};
  if (operators.areas) return {base, 46, 20, 2.75, solid ? 22.0 : 9.0};
  return {base, 18, 20, 2.75, solid ? 11.0 : 5.5};
}

/// The stable step over dx / c: what stiffness a method sees depends on its operators and its support.
double step_factor(const Method& method, int dimension, bool jittered) {
  double factor = jittered ? 0.92 : 1;
  if (!has_pairs(method.formulation)) return factor;
  if (method.viscosity > 0) factor *= 0.62;
  if (has_operators(method.formulation)) {
    const OperatorTraits& operators = operator_traits(method.operators);
    if (operators.exact < 1) return 2.2 * factor;
    if (operators.exact == 1 && !operators.areas && jittered) factor *= 0.7;
  }
  if (dimension == 1) return 1.4 * factor;
  if (method.support_dx > 2) return 1.2 * factor;
  return (dimension == 3 ? 0.8 : 1.0) * factor;
}

/// Periods of the slowest motion until it has died, near-critically damped.
double relaxation_periods(double tolerance) { return std::max(2.1, 0.41 * -std::log10(tolerance)); }

/// Lattice places within a sphere of radius R, in spacings.
double neighbours(double radius, int dimension) {
  const int reach = static_cast<int>(radius);
  double count = -1;  // not itself
  for (int x = -reach; x <= reach; ++x)
    for (int y = dimension > 1 ? -reach : 0; y <= (dimension > 1 ? reach : 0); ++y)
      for (int z = dimension > 2 ? -reach : 0; z <= (dimension > 2 ? reach : 0); ++z)
        count += x * x + y * y + z * z < radius * radius;
  return count;
}

/// Lines of a file, for clouds.
double lines_of(const std::string& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return 0;
  std::ifstream in(file, std::ios::binary);
  std::string part(std::size_t{1} << 16, '\0');
  double lines = 0;
  while (in) {
    in.read(part.data(), static_cast<std::streamsize>(part.size()));
    lines += static_cast<double>(std::count(part.begin(), part.begin() + in.gcount(), '\n'));
  }
  return lines;
}

/// Bounding box of a cloud from a file, and its spacing [m]: that of as many points in the box, or in its
/// volumes where it brings them. 0 where the file cannot be read; said with its place when it is.
double measure_cloud(const Scene& scene, double particles, BodySize& body) {
  constexpr double most = 3e6;  // some seconds
  if (!(particles > 0 && particles < most)) return 0;
  try {
    const CsvTable table(scene.geometry.file);
    double volume = 1;
    for (int d = 0; d < scene.dimension; ++d) {
      const std::size_t column = table.column(std::string(1, static_cast<char>('x' + d)));
      double low = std::numeric_limits<double>::max(), high = -low;
      for (std::size_t i = 0; i < table.rows(); ++i)
        if (const auto value = table.at(i, column).value) {
          low = std::min(low, *value);
          high = std::max(high, *value);
        }
      if (!(high > low)) return 0;
      body.min.push_back(low);
      body.edges.push_back(high - low);
      volume *= high - low;
    }
    body.thickness = *std::min_element(body.edges.begin(), body.edges.end());
    try {
      const std::size_t column = table.column("volume");
      double sum = 0;
      for (std::size_t i = 0; i < table.rows(); ++i) sum += table.at(i, column).value.value_or(0);
      if (sum > 0) volume = sum;
    } catch (const InputError&) {  // has none
    }
    return std::pow(volume / static_cast<double>(table.rows()), 1.0 / scene.dimension);
  } catch (const InputError&) {
    return 0;
  }
}

double first_number(const char* file) {
  std::ifstream in(file);
  double value = 0;
  return in >> value && value > 0 ? value : std::numeric_limits<double>::infinity();
}

/// 11000 of 10879: no more than an estimate can tell.
std::string two_digits(double count) {
  if (count >= 1e6 || count < 10) return fmt::format("{:.2g}", count);
  const double unit = std::pow(10, std::floor(std::log10(count)) - 1);
  return fmt::format("{:.0f}", std::round(count / unit) * unit);
}

std::string size_text(double bytes) {
  if (bytes >= 0.95e9) return fmt::format("{:.3g} GB", bytes * 1e-9);
  return fmt::format("{:.3g} MB", bytes * 1e-6);
}

std::string duration_text(double seconds) {
  if (seconds < 120) return fmt::format("{:.2g} s", seconds);
  if (seconds < 7200) return fmt::format("{:.3g} min", seconds / 60);
  return fmt::format("{:.3g} h", seconds / 3600);
}

}  // namespace

Estimate estimate(const Scene& scene, const RunSpec& run, const SweepPoint& point, int threads) {
  const LatticeSpec lattice = lattice_of(run, point);
  Estimate e;
  double places = 1;  // of the bounding box, which all are asked for
  const bool cloud = scene.geometry.type == "csv";
  BodySize body;
  double dx = lattice.dx;
  if (cloud) {
    e.particles = places = lines_of(scene.geometry.file);
    dx = measure_cloud(scene, e.particles, body);
  } else {
    body = body_size(scene);
    for (const double edge : body.edges)
      places *= std::max(std::round(edge / dx), 1.0) + (lattice.kind == Lattice::node_centred);
    e.particles = std::max(1.0, places * body.fraction);
  }
  const bool updated = is_updated(run.method.formulation);
  const double skin = updated ? 1 + run.method.skin : 1;
  const double each =
      has_pairs(run.method.formulation) ? neighbours(run.method.support_dx * skin, scene.dimension) : 0;
  e.pairs = e.particles * each;
  const bool jittered = cloud || lattice.jitter > 0;
  const bool plain_box = scene.geometry.type == "box" && lattice.kind == Lattice::node_centred;
  const Cost cost = cost_of(run.method, scene.dimension, !jittered, plain_box);
  e.bytes = program_bytes + e.particles * (cost.bytes + cost.bytes_a_pair * each) + 2 * places;

  double speed = wave_speed_of(scene, material_of(scene, run, point));
  for (const RegionSpec& region : scene.regions)
    speed = std::max(speed, wave_speed_of(scene, material_of(scene, region, run, point)));
  double step = run.solve.cfl * step_factor(run.method, scene.dimension, jittered) * dx / speed;
  if (run.solve.mode == "relax") {
    if (step > 0) {
      const double period = slowest_period(scene, run, point, body);
      e.steps =
          (run.solve.free_time + run.solve.ramp_time + relaxation_periods(run.solve.tolerance) * period) /
          step;
      e.steps = std::min(e.steps, static_cast<double>(run.solve.max_steps));
    }
  } else {
    if (run.solve.max_step > 0) step = step > 0 ? std::min(step, run.solve.max_step) : run.solve.max_step;
    e.steps = step > 0 ? run.solve.duration / step : 0;
  }
  e.seconds = e.particles *
              (1e-6 * cost.setup_us + 1e-9 * e.steps * (cost.step_ns + cost.step_ns_a_pair * each)) /
              std::max(threads, 1);
  return e;
}

double memory_limit() {
  double limit = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  limit = std::min(limit, first_number("/sys/fs/cgroup/memory.max"));
  limit = std::min(limit, first_number("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
  rlimit space{};
  if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY)
    limit = std::min(limit, static_cast<double>(space.rlim_cur));
  return limit;
}

void check_size(const Scene& scene, const RunSpec& run, const SweepPoint& point, double limit) {
  const Estimate e = estimate(scene, run, point, 1);
  if (!(e.bytes <= limit)) {
    const std::string what = fmt::format("{:.2g} particles would take some {}, but there are {}", e.particles,
                                         size_text(e.bytes), size_text(limit));
    if (scene.geometry.type == "csv") fail(scene.geometry.place, "[geometry] file: " + what);
    const LatticeSpec lattice = lattice_of(run, point);
    const double room = limit - program_bytes;
    const std::string advice =
        room > 0 ? fmt::format(
                       "dx = {:.2g} would fit",
                       1.02 * lattice.dx * std::pow((e.bytes - program_bytes) / room, 1.0 / scene.dimension))
                 : "nothing would fit";
    fail(lattice.place, fmt::format("[lattice] dx: {:g}: {}; {}", lattice.dx, what, advice));
  }
  constexpr double most_steps = 1e12;
  if (run.solve.mode == "dynamic" && !(e.steps <= most_steps))
    fail(run.solve.place,
         fmt::format("[solve] duration: {:g} s would take about {:.2g} steps, but {:g} is the most",
                     run.solve.duration, e.steps, most_steps));
}

TextTable dry_run(const Scene& scene, int threads, double limit) {
  TextTable table{
      scene.name,
      fmt::format("Estimated for {} thread{} and {} of memory. Steps are good to a factor of three, "
                  "memory to two; seconds suppose a machine that does nothing else.",
                  threads, threads == 1 ? "" : "s", size_text(limit)),
      {"run", "case", "particles", "pairs", "memory", "steps", "time"},
      {}};
  for (const RunSpec& run : scene.runs)
    for (const SweepPoint& point : scene.points()) {
      if (!wanted(run, point)) continue;
      const Estimate e = estimate(scene, run, point, threads);
      const std::string steps = e.steps > 0 ? two_digits(e.steps) : "–";
      table.rows.push_back({{run.label, ""},
                            {describe(point), ""},
                            {fmt::format("{:.3g}", e.particles), "number"},
                            {e.pairs > 0 ? fmt::format("{:.3g}", e.pairs) : "–", "number"},
                            {size_text(e.bytes) + (e.bytes <= limit ? "" : " (too much)"), "number"},
                            {steps, "number"},
                            {e.steps > 0 ? duration_text(e.seconds) : "–", "number"}});
    }
  return table;
}

}  // namespace taut::bench
