#include <fcntl.h>
#include <fmt/format.h>
#include <omp.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <lib/options.hpp>
#include <lib/signals.hpp>
#include <lib/terminal.hpp>
#include <new>
#include <sstream>
#include <taut/base/error.hpp>

namespace taut::bench {
namespace {

/// Without them the first files that are opened would become standard output and standard error.
void open_standard_streams() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0) {
      const int opened = open("/dev/null", O_RDWR);
      if (opened >= 0 && opened != descriptor) {
        dup2(opened, descriptor);
        close(opened);
      }
    }
}

/// OpenMP takes any stack from its environment; below some 100 kB threads fall over it.
void check_stack_size() {
  const char* given = std::getenv("OMP_STACKSIZE");
  if (!given) return;
  char* end = nullptr;
  double kilobytes = std::strtod(given, &end);
  while (std::isspace(static_cast<unsigned char>(*end))) ++end;
  switch (std::tolower(static_cast<unsigned char>(*end))) {
    case 'b':
      kilobytes /= 1024;
      break;
    case 'm':
      kilobytes *= 1024;
      break;
    case 'g':
      kilobytes *= 1048576;
      break;
    default:
      break;  // kilobytes
  }
  if (end != given && kilobytes > 0 && kilobytes < 512)
    throw InputError(fmt::format("OMP_STACKSIZE={}: is too small; give 512k or more, or unset it", given));
}

/// More threads than processors wait for each other: a tenth of a second becomes a minute.
int usable_threads(int wanted, const std::string& name) {
  const int most = std::max(omp_get_num_procs(), 1);
  if (wanted <= most) return std::max(wanted, 1);
  print_error(fmt::format("{}: {} threads are more than the {} processor{} that it may use; using {}\n", name,
                          wanted, most, most == 1 ? "" : "s", most));
  return most;
}

/// A file name such as "-x.toml" is an option to the parser of options.
std::string hint(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--") break;
    if (argument.starts_with('-') && argument.ends_with(".toml"))
      return fmt::format("'{0}' begins as an option does; for the file of that name give ./{0}. ", argument);
  }
  return "";
}

int exit_code(CLI::App& app, const std::string& name, int argc, char** argv,
              const std::function<void(const CommonOptions&)>& body) {
  CommonOptions options;
  options.out = std::filesystem::path("out") / name;
  const int available = std::min(omp_get_max_threads(), std::max(omp_get_num_procs(), 1));
  options.threads = available;
  app.add_option("--out", options.out, "Folder for everything that is written")
      ->type_name("DIR")
      ->capture_default_str();
  const CLI::Option* threads = app.add_option("--threads", options.threads, "Number of threads")
                                   ->type_name("N")
                                   ->check(CLI::Range(1, 4096))
                                   ->capture_default_str();
  app.add_flag("--quick", options.quick, "A smaller version, in seconds instead of minutes");
  app.add_flag("--quiet", options.quiet, "Say nothing but errors");
  app.set_version_flag("--version", name + " " TAUT_VERSION);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    std::ostringstream text, ignored;
    app.exit(success, text, ignored);
    print_out(text.str());
    return done;
  } catch (const CLI::ParseError& error) {
    print_error(fmt::format("{}: {}{}\nTry {} --help.\n", name, hint(argc, argv), error.what(), name));
    return bad_input;
  }
  try {
    check_stack_size();
    options.threads = usable_threads(*threads ? options.threads : omp_get_max_threads(), name);
    omp_set_num_threads(options.threads);
    body(options);
    return done;
  } catch (const Interrupted& interrupted) {
    print_error(fmt::format("{}: {}\n", name, interrupted.what()));
    return 128 + interrupted.signal();
  } catch (const InputError& error) {
    print_error(fmt::format("{}: {}\n", name, error.what()));
    return bad_input;
  } catch (const std::bad_alloc&) {
    print_error(name + ": not enough memory for this run; use a larger dx or a smaller support_dx\n");
  } catch (const std::exception& error) {
    print_error(fmt::format("{}: {}\n", name, error.what()));
  }
  return run_failed;
}

}  // namespace

void sleep_while_waiting(char** argv) {
  for (const char* name : {"OMP_WAIT_POLICY", "GOMP_SPINCOUNT", "KMP_BLOCKTIME"})
    if (std::getenv(name)) return;
  // Of GCC's library: some microseconds, so that a quiet machine loses nothing. Of LLVM's: milliseconds.
  if (setenv("GOMP_SPINCOUNT", "1000", 1) == 0 && setenv("KMP_BLOCKTIME", "0", 1) == 0)
    execv("/proc/self/exe", argv);
}

int run_executable(CLI::App& app, const std::string& name, int argc, char** argv,
                   const std::function<void(const CommonOptions&)>& body) {
  open_standard_streams();
  watch_signals();
  const int code = exit_code(app, name, argc, argv, body);
  if (code != done || !output_lost()) return code;
  print_error(name + ": not all of standard output could be written\n");
  return run_failed;
}

}  // namespace taut::bench
