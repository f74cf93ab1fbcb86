#include <algorithm>
#include <deque>
#include <scaling/step_case.hpp>

namespace taut::bench {
namespace {

/// Sets the bodies up, then steps all in turn.
template <int D>
void measure_group(const Job& job, std::int64_t particles, const std::vector<StepSpec>& specs) {
  std::deque<StepCase<D>> cases;  // which stay where they are
  std::vector<Contestant> contestants;
  std::vector<std::pair<const StepCase<D>*, int>> entries;
  for (const StepSpec& spec : specs) {
    cases.emplace_back(job, particles, spec).add_setup(job);
    for (const int t : spec.threads) {
      contestants.push_back(cases.back().contestant(job, t));
      entries.emplace_back(&cases.back(), t);
    }
  }
  const auto measured =
      job.measure(fmt::format("Steps in {}D, {} particles", D, *cases.front().row().particles), contestants,
                  1e-6, "M particle-steps/s");
  for (std::size_t k = 0; k < entries.size(); ++k) {
    const auto& [of, threads] = entries[k];
    of->add_rate(job, threads, measured[k]);
    for (std::size_t one = 0; one < entries.size(); ++one)
      if (threads > 1 && entries[one].first == of && entries[one].second == 1) {
        Row row = of->row();
        row.threads = threads;
        job.add(row, "ratio_to_one_thread", measured[k].median() / measured[one].median(), "1");
      }
  }
}

/// Set up one after the other where there is no room for all at once.
void measure_size(const Job& job, std::int64_t particles, const std::vector<StepSpec>& specs) {
  constexpr std::int64_t room_for_all = 2'000'000;
  if (particles <= room_for_all) return measure_group<3>(job, particles, specs);
  for (const StepSpec& spec : specs) measure_group<3>(job, particles, {spec});
}

}  // namespace

void measure_steps(const Job& job) {
  using enum PairPrecision;
  using enum Arrangement;
  const std::vector<int> all = {job.threads}, counts = job.thread_counts();
  const std::int64_t main = job.main_particles();
  const int fewest = *std::min_element(job.neighbours.begin(), job.neighbours.end());
  const auto is_main = [&](std::int64_t n) { return n == main; };

  // Rate against particles; those of the main size come below.
  for (const std::int64_t n : job.particles)
    if (!is_main(n))
      measure_size(job, n,
                   {{lattice, fewest, "tl_displacement", shared, all},
                    {jittered, fewest, "tl_displacement", single_precision, all},
                    {lattice, fewest, "ul_basic", automatic, all}});
  if (job.quick) {
    measure_group<3>(job, main,
                     {{lattice, fewest, "tl_displacement", shared, all},
                      {jittered, fewest, "tl_displacement", single_precision, all}});
    return;
  }
  // Rate against threads, neighbours and the precision of the pair vectors.
  for (const int k : job.neighbours) {
    measure_group<3>(job, main,
                     {{lattice, k, "tl_displacement", shared, counts},
                      {lattice, k, "tl_displacement", single_precision, counts},
                      {lattice, k, "tl_displacement", double_precision, all},
                      {lattice, k, "tl_displacement", recomputed, all}});
    measure_group<3>(job, main,
                     {{jittered, k, "tl_displacement", single_precision, counts},
                      {jittered, k, "tl_displacement", double_precision, all},
                      {jittered, k, "tl_displacement", recomputed, all}});
    measure_group<3>(job, main, {{lattice, k, "ul_basic", automatic, counts}});
  }
  // Fewer dimensions.
  measure_group<2>(job, main,
                   {{lattice, 8, "tl_displacement", shared, all},
                    {lattice, 20, "tl_displacement", shared, all},
                    {jittered, 20, "tl_displacement", single_precision, all},
                    {lattice, 20, "ul_basic", automatic, all}});
  measure_group<1>(job, main,
                   {{lattice, 2, "tl_displacement", shared, all},
                    {lattice, 4, "tl_displacement", shared, all},
                    {lattice, 4, "ul_basic", automatic, all}});
}

}  // namespace taut::bench
