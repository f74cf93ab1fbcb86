// taut-scaling: how fast steps and pair lists are, against the machine's limits and other ways to write them.

#include <lib/options.hpp>
#include <scaling/scaling.hpp>

int main(int argc, char** argv) {
  using namespace taut::bench;
  CLI::App app{
      "Times steps and pair lists of cubes of particles, against the machine's limits and against baselines "
      "in the\n"
      "same run, and writes results.csv, report.html and charts to a folder. Let nothing else run beside "
      "it."};
  ScalingOptions options;
  app.add_option("--parts", options.parts, "Only these: " + CLI::detail::join(scaling_parts()))
      ->type_name("PART")
      ->delimiter(',');
  app.add_option("--particles", options.particles, "Numbers of particles")
      ->type_name("N")
      ->delimiter(',')
      ->check(CLI::Range(std::int64_t{1000}, std::int64_t{100'000'000}));
  app.add_option("--neighbours", options.neighbours,
                 "Neighbours of a particle inside a lattice: 18, 32, 56, 80")
      ->type_name("K")
      ->delimiter(',');
  app.add_flag("--large", options.large, "10^7 particles as well");
  app.add_option("--repeats", options.repeats, "Repeats of each measurement (7; 3 when quick)")
      ->type_name("N")
      ->check(CLI::Range(1, 1000));
  const auto page =
      app.add_option("--page", options.page,
                     "Measure nothing: write this Markdown page from the results of an earlier run")
          ->type_name("FILE");
  app.add_option("--from", options.from, "Results of that run (default: results.csv in the output folder)")
      ->type_name("FILE")
      ->needs(page);
  return run_executable(app, "taut-scaling", argc, argv,
                        [&](const CommonOptions& common) { run_scaling(common, options); });
}
