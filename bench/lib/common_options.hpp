#pragma once
/// \file
/// What the options that all executables share come to. Apart from the parser, which is the largest header of
/// all.

#include <filesystem>

namespace taut::bench {

struct CommonOptions {
  std::filesystem::path out;
  int threads = 0;  ///< set to what is used
  bool quick = false, quiet = false;
};

enum ExitCode { done = 0, run_failed = 1, bad_input = 2 };

}  // namespace taut::bench
