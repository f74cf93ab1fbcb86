// What taut-compare --list prints, and that the documents say the same.
#include <doctest/doctest.h>

#include <fstream>
#include <lib/lists.hpp>
#include <lib/names.hpp>
#include <sstream>
#include <taut/base/error.hpp>

using namespace taut;
using namespace taut::bench;

namespace {

std::string text_of(const char* file) {
  std::ifstream in(file);
  REQUIRE(in);
  std::ostringstream all;
  all << in.rdbuf();
  return all.str();
}

}  // namespace

TEST_CASE("tables in the documents are those of the registries: taut-compare --list KIND --markdown") {
  const std::string readme = text_of(TAUT_SCENES "/../../README.md"),
                    scenes = text_of(TAUT_SCENES "/README.md");
  CHECK(readme.find(markdown(list_of("formulations"))) != std::string::npos);
  for (const char* kind : {"operators", "kernels", "materials", "neighbours", "keys"}) {
    CAPTURE(kind);
    const std::string table = markdown(list_of(kind));
    CAPTURE(table);
    CHECK(scenes.find(table) != std::string::npos);
  }
  const Names all = names();
  for (const auto* kind : {&all.formulations, &all.operators, &all.kernels, &all.materials, &all.integrators})
    for (const std::string& name : *kind) {
      CAPTURE(name);
      CHECK(readme.find('`' + name + '`') != std::string::npos);
    }
}

TEST_CASE("every kind has a list, and lists say what there is") {
  for (const std::string& kind : list_kinds()) {
    CAPTURE(kind);
    const TextTable table = list_of(kind);
    CHECK(table.rows.size() >= 2);
    for (const auto& row : table.rows) CHECK(row.size() == table.header.size());
  }
  CHECK(listing(list_of("formulations")).find(" tl_stress_points ") != std::string::npos);
  CHECK_THROWS_WITH_AS(list_of("colours"), doctest::Contains("formulations, operators"), InputError);
}
