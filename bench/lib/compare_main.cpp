#include <lib/compare.hpp>
#include <lib/lists.hpp>
#include <lib/options.hpp>
#include <lib/terminal.hpp>
#include <lib/tolerance.hpp>
#include <taut/base/error.hpp>
#include <taut/compare.hpp>

namespace taut {

int compare_main(int argc, char** argv) {
  using namespace bench;
  CLI::App app{
      "Runs scenes under each method they list, compares with the truth they name, and writes results.csv,\n"
      "report.html, charts, pictures and fields (.vtkhdf) to a folder. Scene files: bench/scenes/README.md."};
  CompareOptions compare;
  app.add_option("scenes", compare.scenes, "Scene files (.toml)")->type_name("SCENE");
  std::string list;
  const CLI::Option* listed =
      app.add_option("--list", list, "Run nothing: list what scenes can choose from, and the keys of runs")
          ->type_name("KIND")
          ->check(CLI::IsMember(list_kinds()));
  bool as_markdown = false;
  app.add_flag("--markdown", as_markdown, "Lists as they stand in the documents");
  app.add_flag("--no-fields", compare.no_fields, "Leave out the .vtkhdf files");
  app.add_flag("--dry-run", compare.dry_run,
               "Run nothing: print particles, pairs, memory, steps and time of every case, estimated");
  std::uint64_t most = 0;
  app.add_option("--max-memory", most,
                 "Refuse cases that would take more, such as 8GB (default: what there is)")
      ->type_name("SIZE")
      ->transform(CLI::AsSizeValue(true));
  std::string tolerance;
  const CLI::Option* wanted =
      app.add_option(
             "--tolerance", tolerance,
             "Instead of the runs, find the cheapest method and spacing whose probes are all within this\n"
             "relative error, such as 1% or 0.01: by cheap pilots, a prediction, and a verifying run.\n"
             "Exit code 1 where none is found")
          ->type_name("ERROR");
  return run_executable(app, "taut-compare", argc, argv, [&](const CommonOptions& common) {
    if (*listed) {
      const TextTable table = list_of(list);
      return print_out(as_markdown ? markdown(table) : listing(table));
    }
    if (compare.scenes.empty())
      throw InputError("scenes is required: name a scene file, or --list KIND. Try --help");
    compare.max_memory = static_cast<double>(most);
    if (*wanted) compare.tolerance = parse_tolerance(tolerance);
    run_compare(common, compare);
  });
}

}  // namespace taut
