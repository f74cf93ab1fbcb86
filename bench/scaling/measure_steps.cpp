#include <scaling/engine_step.hpp>
#include <scaling/job.hpp>

namespace taut::bench {
namespace {

struct StepSpec {
  Arrangement arrangement;
  int neighbours;
  std::string formulation;
  PairPrecision precision;
  std::vector<int> threads;
};

/// Sets up each body, then steps all in turn.
template <int D>
void measure_group(const Job& job, std::int64_t particles, const std::vector<StepSpec>& specs) {
  std::vector<EngineStep<D>> engines;
  engines.reserve(specs.size());
  std::vector<Row> likes, entries;
  std::vector<Contestant> contestants;
  for (const StepSpec& spec : specs) {
    const Neighbourhood& hood = neighbourhood<D>(spec.neighbours, spec.arrangement);
    const Cloud<D> cloud = cube<D>(particles, spec.arrangement);
    Method method;
    method.formulation = spec.formulation;
    method.support_dx = hood.support_dx;
    method.skin = hood.skin;
    method.pair_precision = spec.precision;
    engines.emplace_back(cloud, method);
    const EngineStep<D>& engine = engines.back();
    const bool total = spec.formulation == "tl_displacement";
    Row row;
    row.scene = scene_name<D>(spec.arrangement);
    row.formulation = spec.formulation;
    row.operators = total ? "corrected" : "";
    row.material = total ? "neo_hookean" : "hypoelastic";
    row.kernel = method.kernel;
    row.support_dx = method.support_dx;
    row.dx = cloud.dx;
    row.particles = static_cast<std::int64_t>(cloud.size());
    row.pairs = engine.simulation().pairs();
    row.precision = total ? to_string(spec.precision) : "";
    row.integrator = "leapfrog";
    row.setup_s = engine.simulation().setup_seconds();
    row.bytes_per_particle = engine.bytes_per_particle();
    const std::size_t e = engines.size() - 1;
    for (const int t : spec.threads) {
      row.threads = t;
      entries.push_back(row);
      contestants.push_back(
          {fmt::format("{}, {}, {} ({:.1f}) neighbours, {}, {} threads", total ? "TL" : "UL",
                       to_string(spec.arrangement), spec.neighbours, engine.neighbours(),
                       total ? to_string(spec.precision) : "recomputed", t),
           [&engines, &job, e, t] { return engines[e].rate(t, job.least_seconds); }});
    }
  }
  const auto measured =
      job.measure(fmt::format("Steps in {}D, {} particles", D, engines[0].simulation().size()), contestants,
                  1e-6, "M particle-steps/s");
  for (std::size_t k = 0; k < entries.size(); ++k) {
    entries[k].particle_steps_per_s = measured[k].median();
    job.add(entries[k], "rate", measured[k], "particle-steps/s");
  }
}

}  // namespace

void measure_steps(const Job& job) {
  const std::vector<int> all = {job.threads}, counts = job.thread_counts();
  for (const std::int64_t n : job.particles)
    for (const int neighbours : job.neighbours)
      measure_group<3>(
          job, n,
          {{Arrangement::lattice, neighbours, "tl_displacement", PairPrecision::shared, counts},
           {Arrangement::lattice, neighbours, "tl_displacement", PairPrecision::single_precision, counts},
           {Arrangement::jittered, neighbours, "tl_displacement", PairPrecision::single_precision, counts},
           {Arrangement::lattice, neighbours, "ul_basic", PairPrecision::automatic, all}});
}

}  // namespace taut::bench
