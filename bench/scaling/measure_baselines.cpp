#include <cmath>
#include <scaling/baseline.hpp>
#include <scaling/engine_step.hpp>
#include <scaling/job.hpp>
#include <taut/core/error.hpp>

namespace taut::bench {
namespace {

/// Largest difference over the largest acceleration.
double difference(const std::vector<Vec<3>>& ours, const std::vector<Vec<3>>& theirs) {
  double largest = 0, error = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    largest = std::max(largest, ours[i].norm());
    error = std::max(error, (ours[i] - theirs[i]).norm());
  }
  return error / largest;
}

struct Entry {
  std::string name, formulation, precision;
  int threads;
  double bytes_per_particle;
};

void compare_with_baselines(const Job& job, int neighbours, Arrangement arrangement, std::int64_t wanted) {
  const Cloud<3> cloud = cube<3>(wanted, arrangement);
  Method method;
  method.support_dx = neighbourhood<3>(neighbours, arrangement).support_dx;
  std::vector<PairPrecision> precisions = {PairPrecision::double_precision, PairPrecision::single_precision};
  if (arrangement == Arrangement::lattice) precisions.push_back(PairPrecision::shared);
  std::vector<EngineStep<3>> engines;
  engines.reserve(precisions.size());
  for (const PairPrecision precision : precisions) {
    method.pair_precision = precision;
    engines.emplace_back(cloud, method);
  }
  const auto material =
      std::dynamic_pointer_cast<const Hyperelastic<3>>(make_material<3>("neo_hookean", step_parameters()));
  const BaselineBody body{cloud, method, material};
  std::vector<std::unique_ptr<Baseline>> baselines;
  const std::vector<std::string> names = {"csr", "eigen"};
  baselines.push_back(make_csr_gather(body));
  baselines.push_back(make_eigen_sparse(body));

  Row like;
  like.scene = scene_name<3>(arrangement);
  like.operators = "corrected";
  like.material = "neo_hookean";
  like.kernel = method.kernel;
  like.support_dx = method.support_dx;
  like.dx = cloud.dx;
  like.particles = static_cast<std::int64_t>(cloud.size());
  like.pairs = engines[0].simulation().pairs();
  like.integrator = "leapfrog";

  // Another answer would make the ratio mean nothing.
  constexpr double tolerance = 1e-9;
  for (std::size_t b = 0; b < baselines.size(); ++b) {
    const double error = difference(engines[0].start_accelerations(), baselines[b]->accelerations());
    if (!(error < tolerance))
      throw RunError(
          fmt::format("the {} baseline differs from taut by {:g} in its accelerations", names[b], error));
    Row row = like;
    row.formulation = "baseline_" + names[b];
    job.add(row, "acceleration_difference", error, "1");
  }

  std::vector<Contestant> contestants;
  std::vector<Entry> entries;
  const auto n = static_cast<double>(cloud.size());
  const double dt = engines[0].step();
  for (const int t : job.thread_counts()) {
    for (std::size_t e = 0; e < engines.size(); ++e) {
      entries.push_back(
          {"taut", "tl_displacement", to_string(precisions[e]), t, engines[e].bytes_per_particle()});
      contestants.push_back({fmt::format("taut, {}, {} threads", to_string(precisions[e]), t),
                             [&, e, t] { return engines[e].rate(t, job.least_seconds); }});
    }
    for (std::size_t b = 0; b < baselines.size(); ++b) {
      entries.push_back(
          {names[b], "baseline_" + names[b], "double", t, static_cast<double>(baselines[b]->bytes()) / n});
      contestants.push_back({fmt::format("{}, {} threads", names[b], t), [&, b, t, n] {
                               const auto step = [&] { baselines[b]->step(dt, t); };
                               step();
                               return n / seconds_per_call(step, job.least_seconds);
                             }});
    }
  }
  const auto measured =
      job.measure(fmt::format("TL step against baselines, {} particles, {} of {} neighbours", cloud.size(),
                              to_string(arrangement), neighbours),
                  contestants, 1e-6, "M particle-steps/s");
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const Entry& entry = entries[k];
    Row row = like;
    row.formulation = entry.formulation;
    row.precision = entry.precision;
    row.threads = entry.threads;
    row.bytes_per_particle = entry.bytes_per_particle;
    row.particle_steps_per_s = measured[k].median();
    job.add(row, "rate", measured[k], "particle-steps/s");
    if (entry.name != "taut") continue;
    for (std::size_t other = 0; other < entries.size(); ++other)
      if (entries[other].name != "taut" && entries[other].threads == entry.threads)
        job.add(row, "ratio_to_" + entries[other].name, measured[k].median() / measured[other].median(), "1");
  }
}

}  // namespace

void measure_baselines(const Job& job) {
  std::int64_t particles = 0;
  for (const std::int64_t n : job.particles)
    if (n <= 1'000'000) particles = std::max(particles, n);
  if (particles == 0) particles = 1'000'000;
  for (const int neighbours : job.neighbours)
    compare_with_baselines(job, neighbours, Arrangement::lattice, particles);
  if (!job.quick) compare_with_baselines(job, job.neighbours.front(), Arrangement::jittered, particles);
}

}  // namespace taut::bench
