#pragma once
/// \file
/// What all executables share: options, exit codes, errors on standard error.

#include <CLI/CLI.hpp>
#include <functional>
#include <lib/common_options.hpp>
#include <string>

namespace taut::bench {

/// Adds --out (default out/NAME), --threads, --quick, --quiet, --version to `app`, parses, sets the number of
/// threads (no more than processors) and calls `body`. Returns the exit code: 0 done, 1 run failed, 2 bad
/// input, 128 + signal where one asked for the end; messages go to standard error.
int run_executable(CLI::App& app, const std::string& name, int argc, char** argv,
                   const std::function<void(const CommonOptions&)>& body);

}  // namespace taut::bench
