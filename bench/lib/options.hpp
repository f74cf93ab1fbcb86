#pragma once
/// \file
/// What all executables share: options, exit codes, errors on standard error.

#include <CLI/CLI.hpp>
#include <functional>
#include <lib/common_options.hpp>
#include <string>

namespace taut::bench {

/// Lets threads that wait for others sleep instead of spin, unless the environment says what they shall do:
/// on a machine that has other work, spinning made steps ten times as slow. Starts the program anew, for
/// OpenMP reads its environment before `main`. To be called first; where it cannot be done, nothing changes.
void sleep_while_waiting(char** argv);

/// Adds --out (default out/NAME), --threads, --quick, --quiet, --version to `app`, parses, sets the number of
/// threads (no more than processors) and calls `body`. Returns the exit code: 0 done, 1 run failed, 2 bad
/// input, 128 + signal where one asked for the end; messages go to standard error.
int run_executable(CLI::App& app, const std::string& name, int argc, char** argv,
                   const std::function<void(const CommonOptions&)>& body);

}  // namespace taut::bench
