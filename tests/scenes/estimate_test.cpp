// What a case will take, told before, beside what it took.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <lib/case.hpp>
#include <lib/estimate.hpp>
#include <lib/scene_loader.hpp>
#include <program.hpp>

using namespace taut::bench;

namespace {

/// Estimated steps over those that were made.
double steps_ratio(const Scene& scene, const RunSpec& run, const SweepPoint& point) {
  const Estimate e = estimate(scene, run, point, 1);
  const CaseResult made = run_case(scene, run, point, {});
  INFO(scene.name << ", " << run.label << ": estimated " << e.steps << " steps, made " << made.steps);
  REQUIRE(!made.broke);
  return e.steps / static_cast<double>(made.steps);
}

std::string relaxed(const std::string& name, int dimension, const std::string& body,
                    const std::string& boundaries, const std::string& tolerance = "1e-5") {
  return "[scene]\nname = \"" + name + "\"\ndimension = " + std::to_string(dimension) + "\n[geometry]\n" +
         body + "\n[material]\nmodel = \"st_venant_kirchhoff\"\nE = 1e7\nnu = 0.3\ndensity = 1000.0\n" +
         (dimension == 2 ? "plane = \"stress\"\n" : "") + boundaries +
         "[solve]\nmode = \"relax\"\ntolerance = " + tolerance +
         "\n[[probe]]\nname = \"energy\"\ntype = \"kinetic_energy\"\n[[run]]\nlabel = \"points\"\n" +
         "formulation = \"tl_stress_points\"\n";
}

double steps_ratio(const std::string& text) {
  const Scene scene = parse_scene(text, "estimate.toml");
  return steps_ratio(scene, scene.runs[0], {});
}

std::string box(const char* max, const char* dx) {
  const std::string zeros =
      std::string(max).find(',') == std::string(max).rfind(',') ? "0.0, 0.0" : "0.0, 0.0, 0.0";
  return "type = \"box\"\nmin = [" + zeros + "]\nmax = [" + max + "]\n[lattice]\ndx = " + dx;
}

const std::string clamped = "[[boundary]]\ntype = \"clamp\"\non = \"x_min\"\n";

std::string load(const char* on, const char* direction, const char* force) {
  return std::string("[[boundary]]\ntype = \"load\"\non = \"") + on + "\"\ndirection = [" + direction +
         "]\nforce = " + force + "\n";
}

}  // namespace

TEST_CASE("F5, F7: the steps of shipped scenes are estimated within a factor of two") {
  for (const char* name : {"bar_wave", "bar_wave_2d", "cantilever", "cantilever_convergence", "truss"}) {
    const Scene scene = load_scene(std::string(TAUT_SCENES "/") + name + ".toml", true);
    for (const RunSpec& run : scene.runs) {
      if (run.method.formulation.starts_with("ul_")) continue;  // those break, or nearly
      for (const SweepPoint& point : scene.points()) {
        if (!wanted(run, point) || estimate(scene, run, point, 1).steps > 15000) continue;
        const double ratio = steps_ratio(scene, run, point);
        CHECK(ratio > 0.5);
        CHECK(ratio < 2);
        break;
      }
    }
  }
}

TEST_CASE("F5, F7: the steps of relaxations follow from what holds the body and how it is loaded") {
  const auto good = [](const std::string& text) {
    const double ratio = steps_ratio(text);
    CHECK(ratio > 0.5);
    CHECK(ratio < 2);
  };
  good(relaxed("bending", 3, box("0.2, 0.02, 0.02", "0.01"),
               clamped + load("x_max", "0.0, 0.0, -1.0", "0.1")));
  good(relaxed("pulling", 3, box("0.1, 0.1, 0.1", "0.0125"),
               clamped + load("x_max", "1.0, 0.0, 0.0", "2000.0")));
  good(relaxed("shearing", 2, box("0.2, 0.05", "0.005"),
               "[[boundary]]\ntype = \"clamp\"\non = \"y_min\"\n" + load("y_max", "1.0, 0.0", "5000.0")));
  good(relaxed("both_ends", 2, box("0.2, 0.02", "0.004"),
               clamped +
                   "[[boundary]]\ntype = \"clamp\"\non = \"x_max\"\n[[boundary]]\ntype = \"body_force\"\n" +
                   "acceleration = [0.0, -9.81]\n"));
  good(relaxed("exactly", 2, box("0.2, 0.05", "0.005"), clamped + load("x_max", "1.0, 0.0", "1000.0"),
               "1e-9"));
}

TEST_CASE("F5, F7: rings bend their walls, whichever way they are pushed") {
  const double ratio = steps_ratio(relaxed(
      "ring", 2,
      "type = \"ring\"\ncentre = [0.0, 0.0]\ninner_radius = 0.08\nouter_radius = 0.1\n[lattice]\ndx = 0.005",
      "[[boundary]]\ntype = \"clamp\"\nwhere = { y = [-0.1, -0.09] }\n[[boundary]]\ntype = \"load\"\n"
      "where = { y = [0.09, 0.1] }\ndirection = [0.0, -1.0]\nforce = 5.0\n"));
  CHECK(ratio > 1.0 / 3);
  CHECK(ratio < 3);
}

TEST_CASE("F5: memory is estimated within a factor of two") {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  const auto folder = taut::test::fresh_folder("memory");
  std::string text = relaxed("memory", 2, box("1.0, 1.0", "0.004"),
                             clamped + "[[boundary]]\ntype = \"body_force\"\nacceleration = [1.0, 0.0]\n");
  for (const char* method :
       {"formulation = \"tl_stress_points\"", "formulation = \"tl_displacement\"\njitter = 0.1"}) {
    std::string scene = text;
    scene.replace(scene.find("formulation = "), std::string::npos, std::string(method) + '\n');
    scene.replace(scene.find("mode = \"relax\""), 14, "mode = \"relax\"\nmax_steps = 3");
    std::ofstream(folder / "m.toml") << scene;
    const pid_t child = fork();
    if (child == 0) {
      if (chdir(folder.c_str()) != 0) _exit(99);
      setenv("TAUT_GNUPLOT", "", 1);
      dup2(open("said.txt", O_CREAT | O_WRONLY | O_TRUNC, 0666), 1);
      execl(TAUT_COMPARE, TAUT_COMPARE, "m.toml", "--no-fields", "--out", "o", "--threads", "1", nullptr);
      _exit(99);
    }
    int status = 0;
    rusage used{};
    REQUIRE(wait4(child, &status, 0, &used) == child);
    REQUIRE(status == 0);
    const Scene read = parse_scene(scene, "m.toml");
    const double ratio =
        estimate(read, read.runs[0], {}, 1).bytes / (1024.0 * static_cast<double>(used.ru_maxrss));
    CAPTURE(method);
    CHECK(ratio > 0.5);
    CHECK(ratio < 2);
  }
  std::filesystem::remove_all(folder);
#endif
}

TEST_CASE("F5: clouds from files are measured too") {
  const auto folder = taut::test::fresh_folder("measured");
  std::ofstream file(folder / "cloud.csv");
  file << "x,y\n";
  for (int i = 0; i <= 20; ++i)
    for (int j = 0; j <= 4; ++j) file << 0.01 * i << ',' << 0.01 * j << '\n';
  file.close();
  std::string text = relaxed("cloud", 2, "type = \"csv\"\nfile = \"" + (folder / "cloud.csv").string() + '"',
                             clamped + load("x_max", "0.0, 1.0", "1.0"));
  text.replace(text.find("tl_stress_points"), 16, "tl_displacement");
  const double ratio = steps_ratio(text);
  CHECK(ratio > 1.0 / 3);
  CHECK(ratio < 3);
  std::filesystem::remove_all(folder);
}
