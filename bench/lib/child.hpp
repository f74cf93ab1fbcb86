#pragma once
/// \file
/// Other programs, started without a shell.

#include <sys/types.h>

#include <atomic>
#include <filesystem>
#include <string>
#include <vector>

namespace taut::bench {

struct ChildResult {
  int status = -1;         ///< exit code; −1 where there is none
  bool timed_out = false;  ///< ended after `seconds`
  std::string output;      ///< standard output and error, its first 64 kB
};

/// Runs a program, looked up in PATH, in `folder`, with arguments that nothing interprets, an empty standard
/// input and its own process group. `running` holds its id meanwhile.
ChildResult run_child(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                      double seconds, std::atomic<pid_t>& running);

}  // namespace taut::bench
