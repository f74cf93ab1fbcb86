// formulation = "auto": which rules fire, and that they are documented.

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <lib/auto_rules.hpp>
#include <lib/scene_loader.hpp>
#include <scenes/malformed.hpp>
#include <sstream>

using namespace taut;
using namespace taut::bench;

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

const std::string method_keys =
    "formulation = \"tl_displacement\"\noperators = \"corrected\"\nkernel = \"wendland_c2\"\nsupport_dx = "
    "1.5\n";

/// The run of the good scene with these keys in place of its method.
RunSpec run_with(const std::string& keys, const std::string& what = "", const std::string& by = "") {
  std::string text = replaced(test::good_scene, method_keys, keys);
  if (!what.empty()) text = replaced(text, what, by);
  return parse_scene(text, "auto.toml").runs.at(0);
}

bool says(const RunSpec& run, const std::string& what) {
  return std::any_of(run.automatic.begin(), run.automatic.end(), [&](const FiredRule& rule) {
    return (rule.sets + '|' + rule.when + '|' + rule.why).find(what) != std::string::npos;
  });
}

}  // namespace

TEST_CASE("auto takes stress points on node-centred lattices, in steps and jittered too") {
  const std::string disc = "type = \"sphere\"\ncentre = [0.1, 0.025]\nradius = 0.1";
  const std::string box = "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]";
  for (const RunSpec& run :
       {run_with("formulation = \"auto\"\n"), run_with("formulation = \"auto\"\njitter = 0.1\n"),
        run_with("formulation = \"auto\"\n", box, disc)}) {
    CHECK(run.method.formulation == "tl_stress_points");
    CHECK(run.method.zero_energy_control == 1);  // without it hourglasses have no stiffness
    CHECK(says(run, "formulation = tl_stress_points"));
    CHECK(!says(run, "operators ="));
    CHECK(!says(run, "lock"));
  }
  CHECK(run_with("formulation = \"auto\"\nzero_energy_control = 0.5\n").method.zero_energy_control == 0.5);
}

TEST_CASE("auto takes pairs where the run gives keys of pairs") {
  for (const char* key : {"operators = \"quadratic\"", "kernel = \"lucy\"", "support_dx = 1.6",
                          "neighbours = \"kd_tree\"", "pair_precision = \"double\""})
    CHECK(run_with("formulation = \"auto\"\n" + std::string(key) + '\n').method.formulation ==
          "tl_displacement");
}

TEST_CASE("auto takes operators that close on a plain lattice without stress points too") {
  const RunSpec run = run_with("formulation = \"auto\"\nsupport_dx = 1.5\n");
  CHECK(run.method.formulation == "tl_displacement");
  CHECK(run.method.operators == "compatible");
  CHECK(run.method.kernel == "quadratic");
  CHECK(run.method.support_dx == 1.5);
  CHECK(run.method.zero_energy_control == 0);
  CHECK(says(run, "operators = compatible"));
  CHECK(!says(run, "lock"));
}

TEST_CASE("auto takes operators that close where particles are irregular") {
  const RunSpec jittered = run_with("formulation = \"auto\"\nlattice = \"cell_centred\"\njitter = 0.1\n");
  CHECK(jittered.method.operators == "compatible");
  CHECK(jittered.method.kernel == "lucy");
  const RunSpec disc = run_with("formulation = \"auto\"\nlattice = \"cell_centred\"\n",
                                "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]",
                                "type = \"sphere\"\ncentre = [0.1, 0.025]\nradius = 0.1");
  CHECK(disc.method.operators == "compatible");
  const RunSpec cloud =
      run_with("formulation = \"auto\"\n",
               "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]\n\n[lattice]\ndx = 0.0125",
               "type = \"csv\"\nfile = \"cloud.csv\"");
  CHECK(cloud.method.operators == "compatible");
  CHECK(cloud.method.kernel == "quadratic");
}

TEST_CASE("auto takes an updated Lagrangian form for stress rates, the run's own material first") {
  const RunSpec run = run_with("formulation = \"auto\"\nmaterial = \"hypoelastic\"\n");
  CHECK(run.method.formulation == "ul_artificial_stress");
  CHECK(run.method.kernel == "sinc5");
  CHECK(run.method.support_dx == 2.4);
  CHECK(run.method.velocity_gradient == "corrected");
  CHECK(!says(run, "operators ="));
  const RunSpec other = run_with("formulation = \"auto\"\nmaterial = \"neo_hookean\"\n",
                                 "\"st_venant_kirchhoff\"", "\"hypoelastic\"");
  CHECK(other.method.formulation == "tl_stress_points");
}

TEST_CASE("auto leaves what the run gives") {
  const RunSpec run = run_with("formulation = \"auto\"\noperators = \"standard\"\nkernel = \"lucy\"\n");
  CHECK(run.method.operators == "standard");
  CHECK(run.method.kernel == "lucy");
  CHECK(run.method.support_dx == 1.5);
  CHECK(says(run, "operators as given"));
}

TEST_CASE("auto warns of locking where the thickness is not free, for swept ratios too") {
  const std::string run = "formulation = \"auto\"\nlattice = \"cell_centred\"\n";
  CHECK(says(run_with(run, "nu = 0.3\ndensity = 1000.0\nplane = \"stress\"", "nu = 0.45\ndensity = 1000.0"),
             "lock"));
  CHECK(!says(run_with(run, "nu = 0.3", "nu = 0.45"), "lock"));
  CHECK(!says(run_with(run, "plane = \"stress\"", "plane = \"strain\""), "lock"));
  CHECK(says(run_with(run + "[sweep]\nnu = [0.0, 0.49]\n", "plane = \"stress\"", "plane = \"strain\""),
             "lock"));
  // Cells do not lock, and the note says so.
  CHECK(says(run_with("formulation = \"auto\"\n[sweep]\nnu = [0.0, 0.49]\n", "plane = \"stress\"",
                      "plane = \"strain\""),
             "does not lock"));
}

TEST_CASE("probes can be kept to the formulation that auto chose") {
  const std::string text =
      replaced(replaced(test::good_scene, method_keys, "formulation = \"auto\"\n"), "at = [0.2, 0.025]",
               "at = [0.2, 0.025]\nonly = { formulation = \"tl_stress_points\" }");
  const Scene scene = parse_scene(text, "auto.toml");
  CHECK(wanted(scene.probes[0], scene.runs[0], {}));
}

TEST_CASE("every rule is documented as it is") {
  std::ifstream in(TAUT_SCENES "/README.md");
  std::ostringstream all;
  all << in.rdbuf();
  const std::string text = all.str();
  for (const AutoRule& rule : auto_rules()) {
    const std::string what = *rule.value ? '`' + std::string(rule.key) + " = " + rule.value + '`' : "a note";
    const std::string line = "| " + std::string(rule.when) + " | " + what + " | " + rule.why + " |";
    CAPTURE(line);
    CHECK(text.find(line) != std::string::npos);
  }
}
