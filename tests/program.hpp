#pragma once
// Executables run as their users run them: by a command line, in a folder.

#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <lib/files.hpp>
#include <string>

namespace taut::test {

struct Outcome {
  int status;  ///< exit code, or -1 where there is none
  std::string out, err;
};

/// Runs `program arguments` in a folder, with `environment` ("NAME=value …") set.
inline Outcome run_program(const std::string& program, const std::string& arguments,
                           const std::filesystem::path& folder, const std::string& environment = "") {
  const std::string command = "cd '" + folder.string() + "' && " + environment + " '" + program + "' " +
                              arguments + " >out.txt 2>err.txt";
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, bench::read_file(folder / "out.txt"),
          bench::read_file(folder / "err.txt")};
}

/// An empty folder of this process.
inline std::filesystem::path fresh_folder(const std::string& name) {
  const auto path =
      std::filesystem::temp_directory_path() / ("taut-test-" + name + '-' + std::to_string(getpid()));
  std::filesystem::remove_all(path);
  std::filesystem::create_directories(path);
  return path;
}

}  // namespace taut::test
