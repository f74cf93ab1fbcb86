// What scenes, other programs, full disks and impatient users can do to taut-compare.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <lib/files.hpp>
#include <lib/results.hpp>
#include <program.hpp>
#include <scenes/malformed.hpp>
#include <taut/simulation/simulation.hpp>
#include <thread>

using namespace taut::bench;
using taut::test::fresh_folder;
using taut::test::Outcome;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path;
  explicit Folder(const char* name) : path(fresh_folder(name)) {
    for (const char* file : {"out.txt", "err.txt"}) write(file, "");  // where a test sends them elsewhere
  }
  ~Folder() { fs::remove_all(path); }
  void write(const std::string& name, const std::string& text) const { std::ofstream(path / name) << text; }
  Outcome compare(const std::string& arguments, const std::string& environment = "") const {
    return taut::test::run_program(TAUT_COMPARE, "--threads 1 " + arguments, path, environment);
  }
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

/// A first run that ends at once and a second that would take hours.
std::string endless() {
  return replaced(taut::test::good_scene, "mode = \"relax\"\ntolerance = 1e-4",
                  "mode = \"dynamic\"\nduration = 1e-3") +
         "[[run]]\nlabel = \"endless\"\nformulation = \"tl_displacement\"\nsolve = { duration = 1e4 }\n";
}

/// Starts taut-compare on endless.toml, waits until the first row is there, and sends a signal.
Outcome interrupted(const Folder& folder, int signal_number) {
  folder.write("endless.toml", endless());
  const pid_t child = fork();
  if (child == 0) {
    for (const int number : {SIGINT, SIGTERM}) signal(number, SIG_DFL);
    if (chdir(folder.path.c_str()) != 0) _exit(99);
    dup2(open("out.txt", O_CREAT | O_WRONLY | O_TRUNC, 0666), 1);
    dup2(open("err.txt", O_CREAT | O_WRONLY | O_TRUNC, 0666), 2);
    execl(TAUT_COMPARE, TAUT_COMPARE, "endless.toml", "--out", "result", "--threads", "1", nullptr);
    _exit(99);
  }
  for (int i = 0; i < 3000; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (fs::exists(folder.path / "out.txt") && !read_file(folder.path / "out.txt").empty()) break;
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  kill(child, signal_number);
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(folder.path / "out.txt"),
          read_file(folder.path / "err.txt")};
}

/// Those of results.csv that are of probes.
std::vector<Row> probe_rows(const fs::path& file) {
  std::vector<Row> rows = read_results(file);
  std::erase_if(rows, [](const Row& row) { return row.quantity.starts_with("health_"); });
  return rows;
}

bool anything_unfinished(const fs::path& folder) {
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".tmp") return true;
  return false;
}

}  // namespace

TEST_CASE("F1: nothing that stands in a scene or in the name of a folder is executed") {
  const Folder folder("canary");
  const std::string trap = "`touch canary1` $(touch canary2) '; system(\\\"touch canary3\\\") \\\\";
  std::string text = replaced(taut::test::good_scene, "\"total\"", '"' + trap + '"');
  text += "[sweep]\nload = [500, 1000]\n[[picture]]\ntitle = \"" + trap + "\"\n";
  text = replaced(text, "[geometry]", "title = \"" + trap + "\"\n[geometry]");
  text = replaced(
      text, "at = [0.2, 0.025]",
      "at = [0.2, 0.025]\nreference = { file = \"r.csv\", column = \"`touch canary4`\", keys = { load = "
      "\"load\" }, label = \"" +
          trap + "\" }");
  folder.write("trap.toml", text);
  folder.write("r.csv", "load,`touch canary4`\n500,0.001\n1000,0.002\n");
  const Outcome outcome = folder.compare("trap.toml --out '|`touch canary5`\nsystem(\"touch canary6\")\n'");
  CAPTURE(outcome.err);
  CHECK(outcome.status == 0);
  for (const auto& entry : fs::recursive_directory_iterator(folder.path)) {
    CAPTURE(entry.path().string());
    CHECK(!entry.path().filename().string().starts_with("canary"));
  }
}

TEST_CASE("F1: unknown names and file names do not reach the terminal as they are") {
  const Folder folder("escape");
  folder.write("bad.toml", replaced(taut::test::good_scene, "\"x_max\"", "\"\\u001b[2J\""));
  const Outcome outcome = folder.compare("bad.toml --out '\033[31m'");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("'\\u001b[2J'") != std::string::npos);
  CHECK(outcome.err.find('\x1b') == std::string::npos);
  const Outcome missing = folder.compare("\"$(printf 'no\\033[31mwhere.toml')\"");
  CHECK(missing.status == 2);
  CHECK(missing.err.find('\x1b') == std::string::npos);
  CHECK(missing.err.find("no\\u001b[31mwhere.toml") != std::string::npos);
}

TEST_CASE("F12: values that differ in the seventh digit have rows and files of their own") {
  const Folder folder("digits");
  folder.write("s.toml", taut::test::good_scene + "[sweep]\nnu = [0.4999999, 0.49999995]\n");
  REQUIRE(folder.compare("s.toml --out result").status == 0);
  const std::vector<Row> rows = probe_rows(folder.path / "result/results.csv");
  REQUIRE(rows.size() == 2);
  CHECK(rows[0].quantity != rows[1].quantity);
  CHECK(rows[0].swept.at("nu") == 0.4999999);
  CHECK(rows[1].swept.at("nu") == 0.49999995);
  CHECK(rows[0].label == "total");
  if (taut::has_field_output())
    CHECK(std::distance(fs::directory_iterator(folder.path / "result/fields"), {}) == 2);
}

TEST_CASE("F12: labels in other scripts have files of their own") {
  const Folder folder("scripts");
  folder.write("s.toml", replaced(taut::test::good_scene, "\"total\"", "\"напор\"") +
                             "[[run]]\nlabel = \"отпор\"\nformulation = \"tl_displacement\"\n");
  REQUIRE(folder.compare("s.toml --out result").status == 0);
  if (taut::has_field_output())
    CHECK(std::distance(fs::directory_iterator(folder.path / "result/fields"), {}) == 2);
}

TEST_CASE("F12: one output folder, one job") {
  const Folder folder("two_jobs");
  folder.write("good.toml", taut::test::good_scene);
  const OutputFolder taken(folder.path / "result");
  const Outcome outcome = folder.compare("good.toml --out result");
  CHECK(outcome.status == 1);
  CHECK(outcome.err.find("another job is writing to this folder") != std::string::npos);
}

TEST_CASE("F12: interrupted jobs keep their rows, write the report, say so and end as signals do") {
  for (const int number : {SIGINT, SIGTERM}) {
    const Folder folder("interrupt");
    const Outcome outcome = interrupted(folder, number);
    CAPTURE(outcome.out);
    CAPTURE(outcome.err);
    CHECK(outcome.status == 128 + number);
    CHECK(outcome.err.find("interrupted: 1 of 2 cases are done") != std::string::npos);
    CHECK(probe_rows(folder.path / "result/results.csv").size() == 1);
    CHECK(read_file(folder.path / "result/report.html").find("1 of 2 cases were not run") !=
          std::string::npos);
    CHECK(!anything_unfinished(folder.path));
  }
}

TEST_CASE("F13: fields that cannot be written do not take the computed row with them") {
  if (!taut::has_field_output()) return;
  const Folder folder("full");
  folder.write("good.toml", taut::test::good_scene);
  // Files of 4 kB at most, in place of a disk that is full.
  const Outcome outcome = folder.compare("good.toml --out result", "ulimit -f 8 &&");
  CAPTURE(outcome.err);
  CHECK(outcome.status == 1);
  CHECK(outcome.err.find("cannot write the fields") != std::string::npos);
  CHECK(outcome.err.find("File too large") != std::string::npos);
  CHECK(probe_rows(folder.path / "result/results.csv").size() == 1);
  CHECK(fs::is_empty(folder.path / "result/fields"));
  CHECK(!anything_unfinished(folder.path));
}

TEST_CASE("F16: streams that are closed, full or left change no exit code but where output is lost") {
  const Folder folder("streams");
  folder.write("good.toml", taut::test::good_scene);
  CHECK(folder.compare("nowhere.toml 2>&- #").status == 2);
  CHECK(folder.compare("nowhere.toml 2>/dev/full #").status == 2);
  CHECK(folder.compare("good.toml --out a >&- #").status == 0);
  CHECK(folder.compare("good.toml --out a >/dev/full 2>said.txt #").status == 1);
  CHECK(read_file(folder.path / "said.txt").find("standard output") != std::string::npos);
  // A reader that has gone: the job goes on.
  folder.compare("good.toml --out b | true #");
  CHECK(probe_rows(folder.path / "b/results.csv").size() == 1);
}

TEST_CASE("F17: a gnuplot that never ends is ended, and the report is there") {
  const Folder folder("hangs");
  folder.write("slow", "#!/bin/sh\n[ \"$1\" = --version ] || sleep 100\n");
  fs::permissions(folder.path / "slow", fs::perms::owner_all);
  folder.write("good.toml", taut::test::good_scene + "[sweep]\nload = [1, 2]\n[[picture]]\ntitle = \"t\"\n");
  const auto start = std::chrono::steady_clock::now();
  const Outcome outcome =
      folder.compare("good.toml --out result --no-fields", "TAUT_GNUPLOT=./slow TAUT_GNUPLOT_SECONDS=0.5");
  CHECK(outcome.status == 0);
  CHECK(outcome.err.find("gnuplot did not end within 0.5 s") != std::string::npos);
  CHECK(fs::exists(folder.path / "result/report.html"));
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(60));
}

TEST_CASE("F18: threads beyond the processors are reduced, with a word") {
  const Folder folder("threads");
  folder.write("good.toml", taut::test::good_scene);
  const Outcome outcome = taut::test::run_program(
      TAUT_COMPARE, "--threads 4096 good.toml --out a --no-fields --quiet", folder.path);
  CHECK(outcome.status == 0);
  CHECK(outcome.err.find("4096 threads are more than the") != std::string::npos);
  const Outcome environment = taut::test::run_program(TAUT_COMPARE, "good.toml --out a --no-fields --quiet",
                                                      folder.path, "OMP_NUM_THREADS=100000");
  CHECK(environment.status == 0);
  CHECK(folder.compare("good.toml", "OMP_STACKSIZE=16k").status == 2);
}

TEST_CASE("F18: threads that wait sleep, unless the environment says otherwise") {
  const Folder folder("wait");
  folder.write("good.toml", taut::test::good_scene);
  const std::string told =
      "env -u OMP_WAIT_POLICY -u GOMP_SPINCOUNT -u KMP_BLOCKTIME OMP_DISPLAY_ENV=verbose ";
  const Outcome outcome = folder.compare("good.toml --dry-run", told);
  CHECK(outcome.status == 0);
  if (outcome.err.find("GOMP_SPINCOUNT") == std::string::npos) return;  // another OpenMP
  CHECK(outcome.err.find("GOMP_SPINCOUNT = '1000'") != std::string::npos);
  const Outcome asked = folder.compare("good.toml --dry-run", told + "GOMP_SPINCOUNT=77 ");
  CHECK(asked.err.find("GOMP_SPINCOUNT = '77'") != std::string::npos);
  CHECK(asked.err.find("GOMP_SPINCOUNT = '1000'") == std::string::npos);
}

TEST_CASE("F20: equal runs write equal files, byte by byte") {
  if (!taut::has_field_output()) return;
  const Folder folder("equal");
  folder.write("good.toml", taut::test::good_scene);
  REQUIRE(folder.compare("good.toml --out a", "TAUT_GNUPLOT=").status == 0);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // stamps of time count seconds
  REQUIRE(folder.compare("good.toml --out b", "TAUT_GNUPLOT=").status == 0);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path / "a/fields")) {
    ++files;
    CHECK(read_file(entry.path()) == read_file(folder.path / "b/fields" / entry.path().filename()));
  }
  CHECK(files == 1);
}

TEST_CASE("F20: long arguments are not repeated in full") {
  const Folder folder("long");
  const std::string name(5000, 'a');
  for (const std::string& arguments : {name, "--" + name, "x.toml --tolerance " + name}) {
    const Outcome outcome = folder.compare(arguments);
    CHECK(outcome.status == 2);
    CHECK(outcome.err.size() < 1000);
  }
}

TEST_CASE("F20: a scene whose name begins as an option does") {
  const Folder folder("dash");
  CHECK(folder.compare("-x.toml").err.find("give ./-x.toml") != std::string::npos);
}

TEST_CASE("F15, F20: rows of references that say the same thing twice are refused") {
  const Folder folder("twice");
  folder.write("r.csv", "\xef\xbb\xbfnu,ux\n0.3,1\n0.2,1\n0.3,2\n");
  folder.write("s.toml",
               replaced(taut::test::good_scene, "at = [0.2, 0.025]",
                        "at = [0.2, 0.025]\nreference = { file = \"r.csv\", column = \"ux\", keys = { nu "
                        "= \"nu\" } }") +
                   "[sweep]\nnu = 0.3\n");
  const Outcome outcome = folder.compare("s.toml --out result");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("s.toml:39:") != std::string::npos);
  CHECK(outcome.err.find("r.csv:4: has the same keys as line 2") != std::string::npos);
}

TEST_CASE("F5: many shapes are one union, quickly") {
  const Folder folder("union");
  std::string shapes;
  for (int i = 0; i < 1000; ++i) shapes += "{ type = \"box\", min = [0.0, 0.0], max = [0.2, 0.05] }, ";
  folder.write("u.toml",
               replaced(taut::test::good_scene, "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]",
                        "type = \"union\"\nof = [ " + shapes + "]"));
  CHECK(folder.compare("u.toml --out result --no-fields").status == 0);
}

TEST_CASE("F5, F7: what a case will take is told before, and refused where it is too much") {
  const Folder folder("sizes");
  folder.write("good.toml", taut::test::good_scene + "[sweep]\nload = [1, 2]\n");
  const Outcome table = folder.compare("good.toml --dry-run --out result");
  CHECK(table.status == 0);
  CHECK(table.out.find("load 2 N") != std::string::npos);
  CHECK(table.out.find("  85 ") != std::string::npos);  // 17 × 5 particles
  CHECK(!fs::exists(folder.path / "result"));

  folder.write("fine.toml", replaced(taut::test::good_scene, "dx = 0.0125", "dx = 0.0000049"));
  Outcome outcome = folder.compare("fine.toml --out result --max-memory 8GB");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.starts_with("taut-compare: fine.toml:10:2: [lattice] dx: 4.9e-06: 4.2e+08 particles"));
  CHECK(folder.compare("fine.toml --out result", "ulimit -v 16000000 &&").status == 2);
  CHECK(folder.compare("good.toml --out result --max-memory 1kb").status == 2);

  folder.write("slow.toml", replaced(taut::test::good_scene, "mode = \"relax\"\ntolerance = 1e-4",
                                     "mode = \"dynamic\"\nduration = 1e-3\nmax_step = 1e-20"));
  outcome = folder.compare("slow.toml --out result");
  CHECK(outcome.status == 2);
  CHECK(outcome.err.find("slow.toml:30:2: [solve] duration: 0.001 s would take about 1e+17 steps") !=
        std::string::npos);
  CHECK(!fs::exists(folder.path / "result"));
}
