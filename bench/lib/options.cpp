#include <fmt/format.h>
#include <omp.h>

#include <lib/options.hpp>
#include <new>
#include <taut/core/error.hpp>

namespace taut::bench {

int run_executable(CLI::App& app, const std::string& name, int argc, char** argv,
                   const std::function<void(const CommonOptions&)>& body) {
  CommonOptions options;
  options.out = std::filesystem::path("out") / name;
  const int available = omp_get_max_threads();
  options.threads = available;
  app.add_option("--out", options.out, "Folder for everything that is written")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_option("--threads", options.threads, "Number of threads")
      ->type_name("N")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_flag("--quick", options.quick, "A smaller version, in seconds instead of minutes");
  app.add_flag("--quiet", options.quiet, "Say nothing but errors");
  app.set_version_flag("--version", name + " " TAUT_VERSION);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    return app.exit(success);
  } catch (const CLI::ParseError& error) {
    fmt::print(stderr, "{}: {}\nTry {} --help.\n", name, error.what(), name);
    return bad_input;
  }
  omp_set_num_threads(options.threads);
  try {
    body(options);
    return done;
  } catch (const InputError& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
    return bad_input;
  } catch (const std::bad_alloc&) {
    fmt::print(stderr, "{}: not enough memory for this run; use a larger dx or a smaller support_dx\n", name);
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", name, error.what());
  }
  return run_failed;
}

}  // namespace taut::bench
