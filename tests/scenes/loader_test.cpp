#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <lib/scene_keys.hpp>
#include <lib/scene_loader.hpp>
#include <scenes/malformed.hpp>
#include <set>
#include <sstream>
#include <taut/integrators/integrator.hpp>

using namespace taut;
using namespace taut::bench;

namespace {

std::string message_of(const std::string& text, bool quick = false) {
  try {
    parse_scene(text, "bad.toml", quick);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), by);
}

}  // namespace

TEST_CASE("scenes take every integrator that there is, the documents name them") {
  std::ifstream file(TAUT_SCENES "/README.md");
  const std::string document((std::istreambuf_iterator<char>(file)), {});
  for (const IntegratorEntry& entry : integrators()) {
    CAPTURE(entry.name);
    const Scene scene =
        parse_scene(replaced(test::good_scene, "mode = \"relax\"\ntolerance = 1e-4",
                             "mode = \"dynamic\"\nduration = 1e-3\nintegrator = \"" + entry.name + '"'),
                    "good.toml");
    CHECK(scene.runs.front().solve.integrator == entry.name);
    CHECK(document.find('`' + entry.name + '`') != std::string::npos);
    CHECK_FALSE(entry.line.empty());
  }
}

TEST_CASE("a scene is read as it is written") {
  const Scene scene = parse_scene(test::good_scene, "good.toml");
  CHECK(scene.name == "small");
  CHECK(scene.dimension == 2);
  CHECK(scene.geometry.max == std::vector<double>{0.2, 0.05});
  CHECK(scene.material.parameters.E == 2e6);
  CHECK(scene.material.parameters.plane == Plane::stress);
  REQUIRE(scene.boundaries.size() == 2);
  CHECK(scene.boundaries[0].type == "clamp");
  CHECK(scene.boundaries[1].force == 1000);
  REQUIRE(scene.runs.size() == 1);
  CHECK(scene.runs[0].lattice.dx == 0.0125);
  CHECK(scene.runs[0].lattice.kind == Lattice::node_centred);
  CHECK(scene.runs[0].solve.tolerance == 1e-4);
  CHECK(scene.runs[0].method.support_dx == 1.5);
  CHECK(scene.points().size() == 1);
}

TEST_CASE("a run's own keys win over the scene's") {
  const Scene scene = parse_scene(
      replaced(test::good_scene, "support_dx = 1.5",
               "support_dx = 2.4\nlattice = \"cell_centred\"\ndx = 0.025\nmaterial = \"neo_hookean\"\n"
               "solve = { tolerance = 1e-3 }"),
      "s.toml");
  const RunSpec& run = scene.runs[0];
  CHECK(run.lattice.kind == Lattice::cell_centred);
  CHECK(run.lattice.dx == 0.025);
  CHECK(run.solve.tolerance == 1e-3);
  CHECK(run.solve.mode == "relax");
  CHECK(material_of(scene, run, {}).model == "neo_hookean");
}

TEST_CASE("sweeps combine, and replace what they sweep") {
  const std::string text = test::good_scene + "[sweep]\nnu = [0.0, 0.3]\nload = [1, 2, 3]\n";
  const Scene scene = parse_scene(text, "s.toml");
  const auto points = scene.points();
  REQUIRE(points.size() == 6);
  const SweepPoint& last = points.back();
  CHECK(force_of(scene.boundaries[1], last) == 3);
  CHECK(material_of(scene, scene.runs[0], last).parameters.nu == 0.3);
  CHECK(material_of(scene, scene.runs[0], points.front()).parameters.nu == 0.0);
}

TEST_CASE("probes see the third direction, and scalars of the whole stress") {
  const std::string probe = "[[probe]]\nname = \"s\"\nat = [0.1, 0.025]\ntype = ";
  const auto read = [&](const std::string& rest) {
    return parse_scene(test::good_scene + probe + rest + "\n", "s.toml").probes.back();
  };
  const ProbeSpec across = read("\"cauchy_stress\"\ncomponent = \"zz\"");
  CHECK(across.row == 2);
  CHECK(across.column == 2);
  for (const char* type : {"von_mises", "pressure"}) {
    const ProbeSpec scalar = read('"' + std::string(type) + '"');
    CHECK(scalar.at == std::vector<double>{0.1, 0.025});
    CHECK(scalar.unit() == "Pa");
  }
  const std::string message =
      message_of(test::good_scene + probe + "\"cauchy_stress\"\ncomponent = \"xz\"\n");
  CHECK(message.find("xx, xy, yy, zz") != std::string::npos);
}

TEST_CASE("quick changes a scene when asked for, and is checked even when not") {
  const std::string text = test::good_scene + "[sweep]\nload = [1, 2, 3]\n[quick]\nload = 2\ndx = 0.025\n";
  CHECK(parse_scene(text, "s.toml").points().size() == 3);
  const Scene quick = parse_scene(text, "s.toml", true);
  CHECK(quick.points().size() == 1);
  CHECK(quick.runs[0].lattice.dx == 0.025);
  CHECK(message_of(text + "nu = 0.1\n").find("is not swept") != std::string::npos);
}

TEST_CASE("each mistake is reported with its place and with what is valid") {
  CHECK(test::mistakes().size() >= 20);
  for (const test::Mistake& mistake : test::mistakes()) {
    if (!mistake.loader_finds) continue;
    CAPTURE(mistake.name);
    const std::string text = test::with(mistake);
    REQUIRE(!text.empty());
    const std::string message = message_of(text);
    CAPTURE(message);
    CHECK(message.starts_with("bad.toml:" + std::to_string(mistake.line) + ":"));
    for (const std::string& part : mistake.says) CHECK(message.find(part) != std::string::npos);
  }
}

TEST_CASE("every key is documented, and nothing else is") {
  std::ifstream in(TAUT_SCENES "/README.md");
  REQUIRE(in);
  std::ostringstream all;
  all << in.rdbuf();
  const std::string text = all.str();
  std::set<std::string> tables;
  for (const SceneTable& table : scene_tables()) {
    tables.insert(table.table);
    CAPTURE(table.table);
    // Headings are "## [scene]" or, for arrays of tables, "## [[run]]".
    std::size_t begin = text.find("## [" + table.table + "]");
    if (begin == std::string::npos) begin = text.find("## [[" + table.table + "]]");
    REQUIRE(begin != std::string::npos);
    const std::string section = text.substr(begin, text.find("\n## ", begin + 3) - begin);
    for (const std::string& key : table.keys) {
      CAPTURE(key);
      CHECK(section.find('`' + key + '`') != std::string::npos);
    }
    if (!table.variant.empty() && table.table != "reference") {
      CAPTURE(table.variant);
      CHECK(section.find('`' + table.variant + '`') != std::string::npos);
    }
  }
  for (std::size_t at = text.find("\n## ["); at != std::string::npos; at = text.find("\n## [", at + 1)) {
    const std::size_t begin = text.find_first_not_of('[', at + 4), end = text.find(']', begin);
    CAPTURE(text.substr(begin, end - begin));
    CHECK(tables.contains(text.substr(begin, end - begin)));
  }
}

TEST_CASE("the documented example and all shipped scenes load") {
  std::ifstream in(TAUT_SCENES "/README.md");
  std::ostringstream all;
  all << in.rdbuf();
  const std::string text = all.str();
  const std::size_t begin = text.find("```toml\n") + 8;
  CHECK(parse_scene(text.substr(begin, text.find("```", begin) - begin), "README.md").name == "pull");

  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(TAUT_SCENES)) {
    if (entry.path().extension() != ".toml") continue;
    CAPTURE(entry.path().string());
    CHECK_NOTHROW(load_scene(entry.path()));
    CHECK_NOTHROW(load_scene(entry.path(), true));
    ++scenes;
  }
  CHECK(scenes >= 5);
}

TEST_CASE("a missing scene file is named") {
  try {
    load_scene("nowhere.toml");
    FAIL("nothing thrown");
  } catch (const InputError& error) {
    CHECK(std::string(error.what()).find("nowhere.toml") != std::string::npos);
  }
}
