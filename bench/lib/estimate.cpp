#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <lib/build.hpp>
#include <lib/case.hpp>
#include <lib/estimate.hpp>
#include <lib/names.hpp>
#include <limits>
#include <taut/operators/registry.hpp>

namespace taut::bench {
namespace {

/// Measured on bodies of 64000 to 160801 particles: largest resident size of a whole job over particles, of
/// lattices and jittered ones (R = 1.5 dx, and 2.4 dx for the part of the pairs), set-up seconds a particle
/// on one busy thread; and nanoseconds a particle-step and thread from bench/PERFORMANCE.md.
struct Cost {
  double bytes, bytes_a_pair;      // memory of a particle: bytes + bytes_a_pair · pairs
  double step_ns, step_ns_a_pair;  // a step of a particle likewise
  double setup_us;
};

Cost cost_of(const Method& method, int dimension, bool regular) {
  const bool solid = dimension == 3;
  const FormulationTraits& traits = formulation_traits(method.formulation);
  if (!traits.pairs) return {solid ? 500.0 : 370.0, 0, solid ? 40.0 : 20.0, 0, solid ? 12.0 : 5.0};
  if (traits.reference == Reference::updated) return {solid ? 330.0 : 320.0, 6, 45, 2.5, 3};
  const double base = solid ? 600 : 370;
  if (traits.stress == StressAt::bonds) return {base, 33, 60, 8, 95};  // pairs with a stress of their own
  if (traits.operators) {
    const OperatorTraits& operators = operator_traits(method.operators);
    if (operators.areas && operators.adjoint) return {base, 62, 20, 4, 55};
    if (operators.areas) return {base, 46, 20, 2.75, 70};
  }
  if (regular) return {solid ? 540.0 : 360.0, 0, 7, 0.83, 15};
  return {base, 18, 20, 2.75, 34};
}

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

double first_number(const char* file) {
  std::ifstream in(file);
  double value = 0;
  return in >> value && value > 0 ? value : std::numeric_limits<double>::infinity();
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
  double dx = lattice.dx, longest = 0;
  double places = 1;  // of the bounding box, which all are asked for
  const bool cloud = scene.geometry.type == "csv";
  if (cloud) {
    e.particles = places = lines_of(scene.geometry.file);
  } else {
    const BodySize body = body_size(scene);
    for (const double edge : body.edges) {
      places *= std::max(std::round(edge / dx), 1.0) + (lattice.kind == Lattice::node_centred);
      longest = std::max(longest, edge);
    }
    e.particles = std::max(1.0, places * body.fraction);
  }
  const bool updated = is_updated(run.method.formulation);
  const double skin = updated ? 1 + run.method.skin : 1;
  const double each =
      has_pairs(run.method.formulation) ? neighbours(run.method.support_dx * skin, scene.dimension) : 0;
  e.pairs = e.particles * each;
  const Cost cost = cost_of(run.method, scene.dimension, !cloud && lattice.jitter == 0);
  e.bytes = e.particles * (cost.bytes + cost.bytes_a_pair * each) + 2 * places;

  const double speed = wave_speed_of(scene, material_of(scene, run, point));
  double step = cloud ? 0 : run.solve.cfl * (lattice.jitter > 0 ? 0.8 : 1) * dx / speed;
  if (run.solve.mode == "relax") {
    // Damped to rest in some two periods of a bar that is held at one end.
    e.steps = step > 0 ? 2.2 * 4 * longest / speed / step : 0;
    e.steps = std::min(e.steps, static_cast<double>(run.solve.max_steps));
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
    fail(lattice.place, fmt::format("[lattice] dx: {:g}: {}; dx = {:.2g} would fit", lattice.dx, what,
                                    lattice.dx * std::pow(e.bytes / limit, 1.0 / scene.dimension)));
  }
  constexpr double most_steps = 1e12;
  if (run.solve.mode == "dynamic" && !(e.steps <= most_steps))
    fail(run.solve.place,
         fmt::format("[solve] duration: {:g} s would take about {:.2g} steps, but {:g} is the most",
                     run.solve.duration, e.steps, most_steps));
}

TextTable dry_run(const Scene& scene, int threads, double limit) {
  TextTable table{scene.name,
                  fmt::format("Estimated for {} thread{} and {} of memory. Steps of runs to rest: those of "
                              "stretching; bending takes several times as many.",
                              threads, threads == 1 ? "" : "s", size_text(limit)),
                  {"run", "case", "particles", "pairs", "memory", "steps", "time"},
                  {}};
  for (const RunSpec& run : scene.runs)
    for (const SweepPoint& point : scene.points()) {
      if (!wanted(run, point)) continue;
      const Estimate e = estimate(scene, run, point, threads);
      const std::string steps = e.steps > 0 ? fmt::format("{:.2g}", e.steps) : "–";
      table.rows.push_back({{run.label, ""},
                            {describe(point), ""},
                            {fmt::format("{:.3g}", e.particles), "number"},
                            {e.pairs > 0 ? fmt::format("{:.3g}", e.pairs) : "–", "number"},
                            {size_text(e.bytes) + (e.bytes <= limit ? "" : " (too much)"), "number"},
                            {run.solve.mode == "relax" && e.steps > 0 ? "≥ " + steps : steps, "number"},
                            {e.steps > 0 ? duration_text(e.seconds) : "–", "number"}});
    }
  return table;
}

}  // namespace taut::bench
