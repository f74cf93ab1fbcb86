#include <algorithm>
#include <cstdlib>
#include <lib/files.hpp>
#include <lib/gnuplot.hpp>
#include <lib/terminal.hpp>
#include <scaling/job.hpp>
#include <scaling/page.hpp>
#include <scaling/scaling.hpp>
#include <taut/base/error.hpp>
#include <utility>

namespace taut::bench {
namespace {

using Part = std::pair<std::string, void (*)(const Job&)>;
const std::vector<Part>& parts() {
  static const std::vector<Part> all = {{"stream", measure_machine},
                                        {"steps", measure_steps},
                                        {"baselines", measure_baselines},
                                        {"dense", measure_dense},
                                        {"lists", measure_lists}};
  return all;
}

}  // namespace

const std::vector<std::string>& scaling_parts() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> n;
    for (const Part& part : parts()) n.push_back(part.first);
    return n;
  }();
  return names;
}

void run_scaling(const CommonOptions& common, const ScalingOptions& options) {
  for (const std::string& name : options.parts)
    if (std::find(scaling_parts().begin(), scaling_parts().end(), name) == scaling_parts().end())
      throw InputError(
          fmt::format("--parts: unknown part \"{}\"; valid: {}", name, join_names(scaling_parts())));
  if (!options.page.empty())
    return write_performance_page(options.page,
                                  options.from.empty() ? common.out / "results.csv" : options.from);
  ProgressLine progress(common.quiet, 1);
  std::vector<Row> rows;
  Job job{.particles = options.particles,
          .neighbours = options.neighbours,
          .threads = common.threads,
          .repeats = options.repeats > 0 ? options.repeats
                     : common.quick      ? 3
                                         : 7,
          .quick = common.quick,
          .progress = progress,
          .rows = rows};
  if (job.particles.empty())
    job.particles = common.quick ? std::vector<std::int64_t>{1'000'000}
                                 : std::vector<std::int64_t>{10'000, 100'000, 1'000'000};
  if (options.large) job.particles.push_back(10'000'000);
  if (job.neighbours.empty())
    job.neighbours = common.quick ? std::vector<int>{18} : std::vector<int>{18, 32, 56, 80};
  for (const int neighbours : job.neighbours) neighbourhood<3>(neighbours, Arrangement::lattice);
  if (!std::getenv("OMP_PROC_BIND"))
    progress.say("Steadier with OMP_PROC_BIND=true in the environment, and with nothing else running.");
  const OutputFolder folder(common.out);
  const std::string machine = machine_description();
  write_file(common.out / "machine.txt", machine + '\n');
  for (const auto& [name, measure] : parts()) {
    if (!options.parts.empty() &&
        std::find(options.parts.begin(), options.parts.end(), name) == options.parts.end())
      continue;
    measure(job);
    write_results(common.out / "results.csv", rows);
  }
  const std::vector<std::string> missing = write_scaling_report(rows, machine, common.quick, common.out);
  if (!gnuplot::available())
    progress.say("gnuplot was not found: charts are left as tables (charts/*.csv).");
  else
    for (const std::string& what : missing) print_error("taut-scaling: cannot draw " + what + '\n');
  progress.say("Look at " + (common.out / "report.html").string());
}

}  // namespace taut::bench
