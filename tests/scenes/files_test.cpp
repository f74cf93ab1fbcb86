// Files and folders of a job.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <lib/child.hpp>
#include <lib/files.hpp>
#include <program.hpp>
#include <taut/base/error.hpp>

using namespace taut;
using namespace taut::bench;
namespace fs = std::filesystem;

TEST_CASE("F12: temporary files follow no links, and what is no file is not replaced") {
  const fs::path folder = test::fresh_folder("files");
  std::ofstream(folder / "kept") << "kept";
  for (const char* name : {"results.csv", "results.csv.tmp"})
    fs::create_symlink(folder / "kept", folder / name);
  write_file(folder / "results.csv", "new");
  CHECK(read_file(folder / "kept") == "kept");
  CHECK(read_file(folder / "results.csv") == "new");
  CHECK(!fs::is_symlink(folder / "results.csv"));

  fs::create_directory(folder / "a_folder");
  CHECK_THROWS_AS(write_file(folder / "a_folder", "x"), RunError);
  CHECK_THROWS_AS(write_file("/dev/full", "x"), RunError);
  CHECK(fs::is_character_file("/dev/full"));
  for (const auto& entry : fs::directory_iterator(folder)) CHECK(!entry.path().string().ends_with("x.tmp"));
  CHECK(std::distance(fs::directory_iterator(folder), {}) == 4);
}

TEST_CASE("F12: a folder takes one job at a time, and what killed ones left is cleared") {
  const fs::path folder = test::fresh_folder("lock");
  fs::create_directory(folder / "fields");
  std::ofstream(folder / "fields/.taut-Ab3dE6.tmp") << "half";
  std::ofstream(folder / ".taut-mine.tmp") << "not ours";
  {
    const OutputFolder one(folder);
    CHECK_THROWS_WITH_AS(OutputFolder{folder}, doctest::Contains("another job is writing"), RunError);
    CHECK(!fs::exists(folder / "fields/.taut-Ab3dE6.tmp"));
    CHECK(fs::exists(folder / ".taut-mine.tmp"));
  }
  CHECK_NOTHROW(OutputFolder{folder});
}

TEST_CASE("other programs get their arguments as they are, and no more time than they may have") {
  std::atomic<pid_t> running{0};
  const ChildResult said = run_child({"printf", "%s|", "$(id) `id`", "'\n\""}, "/", 10, running);
  CHECK(said.status == 0);
  CHECK(said.output == "$(id) `id`|'\n\"|");
  CHECK(run_child({"/no/such/program"}, "/", 10, running).status == -1);
  const ChildResult slow = run_child({"sleep", "100"}, "/", 0.1, running);
  CHECK(slow.timed_out);
  CHECK(slow.status == -1);
  CHECK(running == 0);
}
