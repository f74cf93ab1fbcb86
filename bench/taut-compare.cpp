// taut-compare SCENE…: the same scene under each formulation it lists, beside the truth.

#include <lib/compare.hpp>
#include <lib/options.hpp>

int main(int argc, char** argv) {
  using namespace taut::bench;
  CLI::App app{
      "Runs scenes under each method they list, compares with the truth they name, and writes results.csv,\n"
      "report.html, charts, pictures and fields (.vtkhdf) to a folder. Scene files: bench/scenes/README.md."};
  CompareOptions compare;
  app.add_option("scenes", compare.scenes, "Scene files (.toml)")->type_name("SCENE")->required();
  app.add_flag("--no-fields", compare.no_fields, "Leave out the .vtkhdf files");
  return run_executable(app, "taut-compare", argc, argv,
                        [&](const CommonOptions& common) { run_compare(common, compare); });
}
