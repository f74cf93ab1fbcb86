// Probes are placed, and read once, before anything runs; what they give later is a finite number or has no
// status ok.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <lib/case.hpp>
#include <lib/scene_loader.hpp>
#include <scenes/malformed.hpp>

using namespace taut;
using namespace taut::bench;

namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

// What check_case says of the good scene with this in place of its probe; empty when it says nothing.
std::string said_of(const std::string& text) {
  try {
    const Scene scene = parse_scene(text, "scene.toml");
    for (const RunSpec& run : scene.runs) check_case(scene, run, scene.points().front());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
std::string said_of_probe(const std::string& type, const std::string& at, const std::string& lattice = "") {
  std::string text = replaced(test::good_scene, "type = \"displacement\"\naxis = \"x\"\nat = [0.2, 0.025]",
                              type + "\nat = " + at);
  if (!lattice.empty()) text = replaced(text, "dx = 0.0125", "dx = 0.0125\n" + lattice);
  return said_of(text);
}
bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

const std::string displacement = "type = \"displacement\"\naxis = \"x\"";
const std::string velocity = "type = \"velocity\"\naxis = \"x\"";
const std::string stress = "type = \"cauchy_stress\"\ncomponent = \"xx\"";

// The rows of probes, which come before those of health.
std::vector<Row> probe_rows(const CaseResult& result) {
  std::vector<Row> rows = result.rows(1);
  std::erase_if(rows, [](const Row& row) { return row.quantity.starts_with("health_"); });
  return rows;
}

// The good scene made dynamic, with more probes.
Scene swinging(const std::string& probes) {
  const std::string text = replaced(replaced(test::good_scene, "mode = \"relax\"\ntolerance = 1e-4",
                                             "mode = \"dynamic\"\nduration = 1e-3\nsamples = 20"),
                                    "[[run]]", probes + "\n[[run]]");
  return parse_scene(text, "scene.toml");
}

}  // namespace

TEST_CASE("F14: probes of every kind must lie in the body") {
  for (const std::string& type : {displacement, velocity, stress}) {
    CAPTURE(type);
    for (const char* at :
         {"[-200.0, 25.0]", "[1e308, 0.0]", "[0.207, 0.025]", "[0.1, -0.007]", "[0.1, 0.06]"}) {
      CAPTURE(at);
      const std::string text = said_of_probe(type, at);
      CAPTURE(text);
      CHECK(text.starts_with("scene.toml:38:1: [probe] at: 'tip_ux' at ("));
      CHECK(has(text, "outside of the body"));
      CHECK(has(text, "nearest particle"));
    }
    for (const char* at :
         {"[0.2, 0.025]", "[0.0, 0.0]", "[0.2, 0.05]", "[0.071, 0.033]", "[0.206, 0.025]", "[0.1, -0.006]"}) {
      CAPTURE(at);
      CHECK(said_of_probe(type, at) == "");
    }
  }
}

TEST_CASE("no point of the surface is taken for one outside") {
  for (const char* lattice :
       {"kind = \"cell_centred\"", "kind = \"cell_centred\"\njitter = 0.3", "jitter = 0.3"})
    for (int i = 0; i <= 40; ++i) {
      const double s = i / 40.0;
      for (const auto& [x, y] :
           {std::pair{0.2 * s, 0.0}, {0.2 * s, 0.05}, {0.0, 0.05 * s}, {0.2, 0.05 * s}}) {
        const Scene scene =
            parse_scene(replaced(replaced(test::good_scene, "at = [0.2, 0.025]",
                                          "at = [" + std::to_string(x) + ", " + std::to_string(y) + "]"),
                                 "dx = 0.0125", std::string("dx = 0.0125\n") + lattice),
                        "scene.toml");
        if (i % 8 == 0) CHECK_NOTHROW(check_case(scene, scene.runs[0], {}));
      }
    }
  // A ring, whose lattice is a staircase.
  std::string ring =
      replaced(test::good_scene, "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]",
               "type = \"ring\"\ncentre = [0.0, 0.0]\ninner_radius = 0.05\nouter_radius = 0.1");
  ring = replaced(ring, "on = \"x_max\"", "where = { x = [0.08, 0.2] }");
  ring = replaced(ring, "on = \"x_min\"", "where = { x = [-0.2, -0.08] }");
  for (const char* at : {"[0.0707106, 0.0707106]", "[0.05, 0.0]", "[-0.0353553, 0.0353553]", "[0.0, -0.1]",
                         "[0.0866025, 0.05]"}) {
    CAPTURE(at);
    CHECK(said_of(replaced(ring, "at = [0.2, 0.025]", std::string("at = ") + at)) == "");
  }
  CHECK(has(said_of(replaced(ring, "at = [0.2, 0.025]", "at = [0.0, 0.0]")), "outside of the body"));
}

TEST_CASE("probes of clouds from files must lie among their particles") {
  const auto file = std::filesystem::temp_directory_path() / "taut_probe_cloud.csv";
  {  // centres of cells that grow from 1.25 to 5 mm
    std::ofstream out(file);
    out << "x,y,volume\n";
    double left = 0;
    for (double dx = 0.00125; left < 0.06; dx = std::min(0.005, dx * 1.15)) {
      for (int j = 0; j < 8; ++j)
        out << left + dx / 2 << ',' << 0.00125 / 2 + 0.0025 * j << ',' << dx * 0.0025 << '\n';
      left += dx;
    }
  }
  std::string text = replaced(test::good_scene,
                              "type = \"box\"\nmin = [0.0, 0.0]\nmax = [0.2, 0.05]\n\n[lattice]\ndx = 0.0125",
                              "type = \"csv\"\nfile = \"" + file.string() + "\"");
  text = replaced(text, "support_dx = 1.5", "support_dx = 3.4");
  for (const char* at : {"[0.0, 0.01]", "[0.0625, 0.01]", "[0.055, 0.0]", "[0.03, 0.0187]", "[0.0, 0.0]"}) {
    CAPTURE(at);
    CHECK(said_of(replaced(text, "at = [0.2, 0.025]", std::string("at = ") + at)) == "");
  }
  for (const char* at : {"[-0.01, 0.01]", "[0.08, 0.01]", "[0.03, 0.04]", "[-200.0, 25.0]"}) {
    CAPTURE(at);
    CHECK(
        has(said_of(replaced(text, "at = [0.2, 0.025]", std::string("at = ") + at)), "outside of the body"));
  }
  std::filesystem::remove(file);
}

TEST_CASE("F14: an energy that a run has not is found before it runs") {
  std::string text =
      test::good_scene +
      "\n[[run]]\nlabel = \"corotated\"\nformulation = \"tl_displacement\"\nmaterial = \"corotated_svk\"\n";
  text = replaced(text, "[[run]]", "[[probe]]\nname = \"energy\"\ntype = \"strain_energy\"\n\n[[run]]");
  const std::string said = said_of(text);
  CAPTURE(said);
  CHECK(said.starts_with("scene.toml:40:"));
  CHECK(has(said, "'energy' in the run 'corotated'"));
  CHECK(has(said, "corotated_svk"));
}

TEST_CASE("a loaded body that nothing holds is found before it runs") {
  const std::string said = said_of(
      replaced(test::good_scene, "type = \"clamp\"\non = \"x_min\"", "type = \"roller\"\non = \"y_min\""));
  CAPTURE(said);
  CHECK(said.starts_with("scene.toml:40:"));
  CHECK(has(said, "'total'"));
  CHECK(has(said, "free to move along x"));
}

TEST_CASE("F7: a step that never reaches the end is found before it runs") {
  const std::string said = said_of(replaced(test::good_scene, "mode = \"relax\"\ntolerance = 1e-4",
                                            "mode = \"dynamic\"\nduration = 1e-3\nmax_step = 1e-20"));
  CHECK(has(said, "never reach 0.001 s"));
}

TEST_CASE("F15: a window after the end is found when the scene is read") {
  try {
    swinging(
        "[[probe]]\nname = \"late\"\ntype = \"kinetic_energy\"\nmeasure = \"peak\"\nwindow = [2e-3, 3e-3]\n");
    FAIL("was taken");
  } catch (const InputError& error) {
    CHECK(has(error.what(), "'late' begins at 0.002 s, after the end of the run 'total' at 0.001 s"));
  }
}

TEST_CASE("F15: what is divided by nothing has no value and no status ok") {
  const Scene scene = swinging(
      "[[probe]]\nname = \"still\"\ntype = \"velocity\"\naxis = \"y\"\nat = [0.0, 0.025]\nmeasure = "
      "\"peak\"\n"
      "[[probe]]\nname = \"ratio\"\ntype = \"kinetic_energy\"\nmeasure = \"peak\"\nover = \"still\"\n");
  const CaseResult result = run_case(scene, scene.runs[0], {}, {});
  const auto rows = probe_rows(result);
  REQUIRE(rows.size() == 3);
  CHECK(rows[0].status == "ok");
  CHECK(rows[1].status == "ok");
  CHECK(rows[2].status != "ok");
  CHECK(!rows[2].value);
  CHECK(has(result.measured[2].why_none, "'still', which divides it, is zero"));
}

TEST_CASE("F15: directions are directions whatever their length") {
  for (const char* direction : {"[1e200, 0.0]", "[1e-200, 0.0]", "[3.0, 0.0]"}) {
    CAPTURE(direction);
    const Scene scene = parse_scene(
        replaced(test::good_scene, "direction = [1.0, 0.0]", std::string("direction = ") + direction),
        "s.toml");
    const CaseResult result = run_case(scene, scene.runs[0], {}, {});
    REQUIRE(result.measured[0].value);
    CHECK(*result.measured[0].value == doctest::Approx(2e-3).epsilon(0.1));
  }
}

TEST_CASE("F8: a sweep that begins with no load ends") {
  const Scene scene = parse_scene(test::good_scene + "[sweep]\nload = [0, 100]\n", "s.toml");
  const auto points = scene.points();
  const CaseResult none = run_case(scene, scene.runs[0], points[0], {});
  CHECK(!none.broke);
  CHECK(none.steps < 50);
  REQUIRE(none.measured[0].value);
  CHECK(std::abs(*none.measured[0].value) < 1e-12);
  CHECK(!run_case(scene, scene.runs[0], points[1], {}).broke);
}

TEST_CASE("F8: a relaxation that does not end says which condition is not met") {
  const auto what = [](const char* solve) {
    const Scene scene = parse_scene(replaced(test::good_scene, "tolerance = 1e-4", solve), "s.toml");
    return run_case(scene, scene.runs[0], {}, {}).what;
  };
  CHECK(has(what("tolerance = 1e-9\nmax_steps = 40"), "within 40 steps: out-of-balance force"));
  CHECK(has(what("tolerance = 0.999\nmax_steps = 40"), "the body still moves"));
}

TEST_CASE("stress probes take the particles that are nearest, whatever the units") {
  // A kilometre of rock under its weight in km, kg and s.
  const Scene scene = parse_scene(R"(
scene = { name = "km_kg_s", dimension = 1 }
geometry = { type = "box", min = [0.0], max = [1.0] }
lattice = { dx = 0.01 }
material = { model = "linear_elastic", E = 5e13, nu = 0.25, density = 2.7e12 }
boundary = [{ type = "clamp", on = "x_min" }, { type = "body_force", acceleration = [-0.00981] }]
solve = { mode = "relax" }
probe = [{ name = "foot", type = "cauchy_stress", component = "xx", at = [0.0], reference = -2.6487e10 },
         { name = "quarter", type = "cauchy_stress", component = "xx", at = [0.25], reference = -1.986525e10 },
         { name = "top", type = "displacement", axis = "x", at = [1.0], reference = -2.20725e-4 }]
run = [{ label = "corrected", formulation = "tl_displacement" }, { label = "stress points", formulation = "tl_stress_points" }]
)",
                                  "km.toml");
  for (const RunSpec& run : scene.runs)
    for (const Row& row : probe_rows(run_case(scene, run, {}, {}))) {
      CAPTURE(row.quantity);
      REQUIRE(row.error);
      CHECK(std::abs(*row.error) < 0.01);
    }
}
