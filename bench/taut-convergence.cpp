// taut-convergence [STUDY…]: which methods converge, how fast, and at what cost.

#include <convergence/convergence.hpp>
#include <lib/options.hpp>

int main(int argc, char** argv) {
  using namespace taut::bench;
  sleep_while_waiting(argv);
  CLI::App app{
      "Refines bodies with known answers under every formulation, operator and support that can run them, "
      "prints errors and orders, and\n"
      "writes results.csv, report.html and charts to a folder."};
  std::vector<std::string> studies;
  StudyOptions options;
  options.scenes = TAUT_SCENE_FOLDER;
  std::string valid;
  for (const std::string& name : study_names()) valid += (valid.empty() ? "" : ", ") + name;
  app.add_option("studies", studies, "Which studies to run, of " + valid + "; all where none is named")
      ->type_name("STUDY");
  app.add_option("--scenes", options.scenes, "Folder of the scene files that studies start from")
      ->type_name("DIR")
      ->capture_default_str();
  return run_executable(app, "taut-convergence", argc, argv, [&](const CommonOptions& common) {
    options.common = common;
    run_convergence(options, studies);
  });
}
