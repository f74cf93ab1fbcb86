#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <taut/base/error.hpp>
#include <taut/geometry/geometry.hpp>

using taut::Cloud;
using taut::InputError;
using taut::Vec;

namespace {

// A file that goes away with the test.
struct Csv {
  std::filesystem::path path;
  explicit Csv(const std::string& text)
      : path(std::filesystem::temp_directory_path() /
             ("taut_cloud_" + std::to_string(getpid()) + "_" + std::to_string(++count()) + ".csv")) {
    std::ofstream(path, std::ios::binary) << text;
  }
  Csv(const Csv&) = delete;
  Csv& operator=(const Csv&) = delete;
  ~Csv() { std::filesystem::remove(path); }
  static int& count() {
    static int n = 0;
    return n;
  }
};

template <int D>
std::string failure(const std::string& text, double dx = 1) {
  const Csv file(text);
  try {
    taut::read_cloud<D>(file.path, dx);
  } catch (const InputError& e) {
    const std::string what = e.what(), path = file.path.string();
    REQUIRE(what.substr(0, path.size()) == path);
    return what.substr(path.size());
  }
  return "no failure";
}

}  // namespace

TEST_CASE("positions alone: the body ends at the outermost") {
  const Csv file("x,y\n0,0\n0.5,0\n0,0.5\n0.5,0.5\n");
  const Cloud<2> c = taut::read_cloud<2>(file.path, 0.5);
  REQUIRE(c.size() == 4);
  CHECK(c.X[2] == Vec<2>(0, 0.5));
  CHECK(c.V[3] == doctest::Approx(0.0625).epsilon(1e-12));
  CHECK(c.B.empty());
  CHECK(c.dx == 0.5);
}

TEST_CASE("comments, blank lines, blanks, CRLF, a byte order mark, any order of columns") {
  const Csv file(
      "\xef\xbb\xbf# a cloud\r\n\r\n volume , bz,by,bx, z,y ,x # header\r\n\t1e-3,3,2,1, +6 ,5,-4.5e0\r\n  # "
      "between\r\n2,0,0,0,1,1,1");
  const Cloud<3> c = taut::read_cloud<3>(file.path, 2);
  REQUIRE(c.size() == 2);
  CHECK(c.X[0] == Vec<3>(-4.5, 5, 6));
  CHECK(c.B[0] == Vec<3>(1, 2, 3));
  CHECK(c.V[0] == 1e-3);
  CHECK(c.V[1] == 2);
}

TEST_CASE("one dimension: x, volume, bx") {
  const Csv file("x,volume,bx\n0,.5,-1\n1,1,0\n2,.5,1\n");
  const Cloud<1> c = taut::read_cloud<1>(file.path);
  CHECK(c.dx == 1);
  CHECK(c.B[0][0] == -1);
  CHECK(c.V[1] == 1);
}

TEST_CASE("without a spacing the median nearest distance is taken, or the volume's if that is larger") {
  std::string text = "x,y,volume\n";
  for (int i = 0; i < 20; ++i)
    for (int j = 0; j < 10; ++j)
      text += std::to_string(0.25 * i) + "," + std::to_string(0.25 * j) + ",0.0625\n";
  const Csv file(text + "100,100,0.0625\n100.001,100,0.0625\n");  // two that stray
  const Cloud<2> c = taut::read_cloud<2>(file.path);
  CHECK(c.dx == doctest::Approx(0.25));
  CHECK(c.V[0] == 0.0625);
  const Csv long_cells("x,y,volume\n0,0,9\n1,0,9\n2,0,9\n0,9,9\n1,9,9\n2,9,9\n");
  CHECK(taut::read_cloud<2>(long_cells.path).dx == 3);
}

TEST_CASE("nodes of a square without a volume column have its mass") {
  std::string text = "x,y\n";
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) text += std::to_string(0.25 * i) + "," + std::to_string(0.25 * j) + "\n";
  const Csv file(text);
  const Cloud<2> c = taut::read_cloud<2>(file.path);
  double volume = 0;
  for (const double V : c.V) volume += V;
  CHECK(std::abs(volume - 1) < 1e-12);
  CHECK(c.dx == doctest::Approx(0.25).epsilon(1e-12));
}

TEST_CASE("facets: several of a particle, none of others") {
  const Csv file(
      "x,y,volume,bx,by,fx,fy\n0.5,0.5,1,-1,0,0,0.5\n1.5,0.5,1,0,-1,1.5,0\n0.5,0.5,,0,-1,0.5,0\n"
      "1.5,1.5,1,0,0,0,0\n");
  const Cloud<2> c = taut::read_cloud<2>(file.path, 1);
  REQUIRE(c.size() == 3);
  REQUIRE(c.V.size() == 3);
  CHECK(c.B.empty());
  REQUIRE(c.facets.size() == 3);
  CHECK(c.facets[2].owner == 0);
  CHECK(c.facets[2].area == Vec<2>(0, -1));
  CHECK(c.facets[2].centre == Vec<2>(0.5, 0));
  CHECK(c.facets[1].owner == 1);
}

TEST_CASE("errors name the file, the line and what would be right") {
  CHECK(failure<2>("x,y\n1,2\n3,four\n") == ":3: column y: \"four\" is no finite number");
  CHECK(failure<2>("x,y\n\n# comment\n1,nan\n") == ":4: column y: \"nan\" is no finite number");
  CHECK(failure<2>("x,y\n-inf,0\n") == ":2: column x: \"-inf\" is no finite number");
  CHECK(failure<2>("x,y\n1e999,0\n") == ":2: column x: \"1e999\" is no finite number");
  CHECK(failure<2>("x,y\n1 2,0\n") == ":2: column x: \"1 2\" is no finite number");
  CHECK(failure<2>("x,y\n,0\n") == ":2: column x: \"\" is no finite number");
  CHECK(failure<2>("x,y\n+-1,0\n") == ":2: column x: \"+-1\" is no finite number");
  CHECK(failure<2>("x,y\n1,2\n1,2,3\n") == ":3: 3 fields where the header names 2");
  CHECK(failure<2>("x,y\n1\n") == ":2: 1 fields where the header names 2");
  CHECK(failure<2>("x,y\n1,2,\n") == ":2: 3 fields where the header names 2");
  CHECK(failure<3>("# positions\nx,y\n1,2\n") ==
        ":2: missing column z; valid in 3D: x, y, z, volume, bx, by, bz, fx, fy, fz");
  CHECK(failure<3>("volume\n1\n") ==
        ":1: missing column x, y, z; valid in 3D: x, y, z, volume, bx, by, bz, fx, fy, fz");
  CHECK(failure<2>("x,y,z\n1,2,3\n") ==
        ":1: unknown column \"z\"; valid in 2D: x, y, volume, bx, by, fx, fy");
  CHECK(failure<2>("x,y,bx\n1,2,3\n") == ":1: missing column by; valid in 2D: x, y, volume, bx, by, fx, fy");
  CHECK(failure<2>("x,y,x\n1,2,3\n") == ":1: column x twice");
  CHECK(failure<1>("x,volume\n1,1\n2,0\n") == ":3: column volume: 0 is not positive");
  CHECK(failure<1>("x,volume\n1,-1\n") == ":2: column volume: -1 is not positive");
  CHECK(failure<1>("") == ":1: no header line");
  CHECK(failure<1>("# nothing\n") == ":1: no header line");
  CHECK(failure<1>("x\n\n") == ":2: no particles after the header");
  CHECK(failure<1>("x\n1\n", 0) == ":2: the spacing dx must be given for a single particle");
  CHECK(failure<1>("x\n1\n1\n1\n2\n", 0) ==
        ":5: no spacing dx to be found: most particles coincide with another");
  CHECK(failure<2>("x,y,volume,fx,fy\n") ==
        ":1: missing column bx, by; valid in 2D: x, y, volume, bx, by, fx, fy");
  CHECK(failure<2>("x,y,bx,by,fx,fy\n") == ":1: missing column volume, which goes with fx, fy");
  CHECK(failure<1>("x,volume,bx,fx\n1,1,1,1\n1,1,1,1\n") ==
        ":3: the position of particle 0 again: another facet of it has an empty volume, another particle a "
        "place "
        "of its own");
  CHECK(failure<1>("x,volume,bx,fx\n1,,1,1\n") == ":2: column volume: \"\" is no finite number");
  CHECK(failure<1>("x,volume,bx,fx\n1,1,0,1\n") == ":2: columns of facets, but all areas are zero");
  CHECK(failure<1>("x,volume\n1,1e308\n2,1e308\n") ==
        ": coordinates or volumes too large to be computed with");
  CHECK(failure<1>("x,volume\n1,1\n1e200,1\n") == ": coordinates or volumes too large to be computed with");
  CHECK(failure<2>("x,y\n0,0\n1,0\n2,0\n")
            .starts_with(": there is no column volume, and from the points alone: particle 0 at (0, 0) lies "
                         "on no part of the body"));
  CHECK(failure<1>("x\n" + std::string(1000001, '1')) ==
        ":2: a line of more than 1000000 bytes: this is no table of particles");
  CHECK(failure<1>("x\n1\n", -1) == ": spacing -1 is negative or not finite");
}

TEST_CASE("files that are not there") {
  const auto nowhere = std::filesystem::temp_directory_path() / "taut_no_such_file.csv";
  CHECK_THROWS_WITH_AS(taut::read_cloud<2>(nowhere), (nowhere.string() + ": cannot be opened").c_str(),
                       InputError);
  CHECK_THROWS_AS(taut::read_cloud<2>(std::filesystem::temp_directory_path()), InputError);
  if (std::filesystem::exists("/dev/zero"))
    CHECK_THROWS_WITH_AS(taut::read_cloud<2>("/dev/zero"), doctest::Contains("a line of more than"),
                         InputError);
}
