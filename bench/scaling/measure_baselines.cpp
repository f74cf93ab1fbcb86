#include <cmath>
#include <deque>
#include <scaling/baseline.hpp>
#include <scaling/step_case.hpp>
#include <taut/base/error.hpp>

namespace taut::bench {
namespace {

/// Largest difference over the largest acceleration.
double difference(const std::vector<Vec<3>>& a, const std::vector<Vec<3>>& b) {
  double largest = 0, error = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, a[i].norm());
    error = std::max(error, (a[i] - b[i]).norm());
  }
  return error / largest;
}

struct Rival {
  std::string name;
  std::unique_ptr<Baseline> baseline;
};

void compare_with_baselines(const Job& job, int neighbours, Arrangement arrangement) {
  const std::vector<int> counts = job.thread_counts();
  std::vector<PairPrecision> precisions = {PairPrecision::double_precision, PairPrecision::single_precision};
  if (arrangement == Arrangement::lattice) precisions.push_back(PairPrecision::shared);
  const Cloud<3> cloud = cube<3>(job.main_particles(), arrangement);
  const auto n = static_cast<double>(cloud.size());
  std::deque<StepCase<3>> cases;
  for (const PairPrecision precision : precisions)
    cases.emplace_back(job, job.main_particles(),
                       StepSpec{arrangement, neighbours, "tl_displacement", precision, counts});

  const BaselineBody body{
      cloud, cases[0].method(),
      std::dynamic_pointer_cast<const Hyperelastic<3>>(make_material<3>("neo_hookean", step_parameters()))};
  std::vector<Rival> rivals;
  rivals.push_back({"csr", make_csr_gather(body)});
  rivals.push_back({"eigen", make_eigen_sparse(body)});

  // Another answer would make a ratio mean nothing.
  const std::vector<Vec<3>> expected = cases[0].engine().start_accelerations();
  const auto check = [&](Row row, const std::vector<Vec<3>>& a, double tolerance) {
    const double error = difference(expected, a);
    if (!(error < tolerance))
      throw RunError(fmt::format(
          "{} of {} pair vectors differs from taut in double precision by {:g} in its accelerations",
          row.formulation, row.precision, error));
    job.add(std::move(row), "acceleration_difference", error, "1");
  };
  constexpr double round_off = 1e-10, single_round_off = 1e-5;
  for (std::size_t c = 1; c < cases.size(); ++c)
    check(cases[c].row(), cases[c].engine().start_accelerations(),
          precisions[c] == PairPrecision::single_precision ? single_round_off : round_off);
  const auto rival_row = [&](const Rival& rival) {
    Row row = cases[0].row();
    row.formulation = "baseline_" + rival.name;
    row.setup_s.reset();
    row.bytes_per_particle = static_cast<double>(rival.baseline->bytes()) / n;
    return row;
  };
  for (const Rival& rival : rivals) check(rival_row(rival), rival.baseline->accelerations(), round_off);

  std::vector<Contestant> contestants;
  const double dt = cases[0].engine().step();
  for (const int t : counts) {
    for (StepCase<3>& c : cases) contestants.push_back(c.contestant(job, t));
    for (const Rival& rival : rivals)
      contestants.push_back({fmt::format("{}, {}", rival.name, thread_label(t)), [&, t] {
                               const auto step = [&] { rival.baseline->step(dt, t); };
                               step();
                               return n / seconds_per_call(step, job.least_seconds);
                             }});
  }
  const auto measured = job.measure(fmt::format("TL step against baselines, {} particles, {}, {} neighbours",
                                                cloud.size(), to_string(arrangement), neighbours),
                                    contestants, 1e-6, "M particle-steps/s");
  const std::size_t all = cases.size() + rivals.size();
  for (std::size_t k = 0; k < counts.size(); ++k) {
    for (std::size_t r = 0; r < rivals.size(); ++r) {
      const Samples& rate = measured[k * all + cases.size() + r];
      Row row = rival_row(rivals[r]);
      row.threads = counts[k];
      row.particle_steps_per_s = rate.median();
      job.add(row, "rate", rate, "particle-steps/s");
    }
    for (std::size_t c = 0; c < cases.size(); ++c) {
      const Samples& rate = measured[k * all + c];
      cases[c].add_rate(job, counts[k], rate);
      Row row = cases[c].row();
      row.threads = counts[k];
      row.particle_steps_per_s = rate.median();
      for (std::size_t r = 0; r < rivals.size(); ++r)
        job.add(row, "ratio_to_" + rivals[r].name,
                rate.median() / measured[k * all + cases.size() + r].median(), "1");
    }
  }
}

}  // namespace

void measure_baselines(const Job& job) {
  for (const int neighbours : job.neighbours) compare_with_baselines(job, neighbours, Arrangement::lattice);
  if (!job.quick) compare_with_baselines(job, job.neighbours.front(), Arrangement::jittered);
}

}  // namespace taut::bench
