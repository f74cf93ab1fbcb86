// Bodies far from the origin of their coordinates, and small strains: digits that do not cancel.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <taut/geometry/local_origin.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

constexpr double E = 210e9;

// No extent is a binary fraction: far away, the coordinates of all faces are rounded.
Cloud<2> bar(const Vec<2>& at, const Method& method, Lattice lattice = Lattice::node_centred) {
  return make_cloud(
      box<2>(at, at + Vec<2>(0.7, 0.3)),
      {.dx = 0.1, .lattice = lattice, .cells = method.formulation == std::string("tl_stress_points")});
}

struct Offset {
  const char* name;
  Vec<2> at;
};
const std::vector<Offset>& offsets() {
  static const std::vector<Offset> all = {{"1 km", {1000, 1000}},
                                          {"map", {5e5, 5.4e6}},
                                          {"map, below", {-5e5, -5.4e6}},
                                          {"map in mm", {5e8, 5.4e9}},
                                          {"1e9", {1e9, 1e9}}};
  return all;
}

std::vector<std::pair<const char*, Method>> total_lagrangian() {
  return {{"standard", {.operators = "standard"}},
          {"corrected", {}},
          {"corrected, controlled", {.zero_energy_control = 1}},
          {"compatible", {.operators = "compatible", .kernel = "quadratic"}},
          {"quadratic", {.operators = "quadratic", .support_dx = 2.6}},
          {"bonds", {.formulation = "tl_bond_associated"}},
          {"stress points", {.formulation = "tl_stress_points"}}};
}

// Held at two faces and pulled at the third, to a strain of the given size.
void pull(Simulation<2>& s, double strain) {
  s.roller(s.face("x_min"), 0);
  s.roller(s.face("y_min"), 1);
  s.load(s.face("x_max"), {strain * E * 0.3, 0});
}

std::vector<Vec<2>> displacements(const Simulation<2>& s) {
  std::vector<Vec<2>> u;
  for (std::size_t i = 0; i < s.size(); ++i) u.push_back(s.displacement(i));
  return u;
}

// Largest difference over the largest displacement.
template <int D = 2>
double difference(const std::vector<Vec<D>>& a, const std::vector<Vec<D>>& b) {
  REQUIRE(a.size() == b.size());
  double largest = 0, apart = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, b[i].norm());
    apart = std::max(apart, (a[i] - b[i]).norm());
  }
  REQUIRE(largest > 0);
  return apart / largest;
}

std::shared_ptr<const Material<2>> steel(const char* law = "linear_elastic") {
  return make_material<2>(law, {.E = E, .nu = 0.3, .density = 7850, .plane = Plane::stress});
}

std::vector<Vec<2>> relaxed(const Cloud<2>& cloud, const Method& method, double strain = 1e-4,
                            const char* law = "linear_elastic") {
  Simulation<2> s(cloud, steel(law), method);
  pull(s, strain);
  CHECK(s.relax({.max_steps = 20000}).status == Status::ok);
  return displacements(s);
}

}  // namespace

TEST_CASE("total Lagrangian bodies come to the same rest wherever they lie") {
  for (const auto& [name, method] : total_lagrangian()) {
    CAPTURE(std::string(name));
    const auto here = relaxed(bar({0, 0}, method), method);
    for (const Offset& offset : offsets()) {
      CAPTURE(offset.name);
      CHECK(difference(relaxed(bar(offset.at, method), method), here) < 1e-9);
    }
  }
}

TEST_CASE("updated Lagrangian bodies move in the same way wherever they lie") {
  for (const char* formulation : {"ul_basic", "ul_artificial_stress"}) {
    CAPTURE(formulation);
    const Method method{.formulation = formulation, .support_dx = 2.4, .viscosity = 0.5};
    const auto moved = [&](const Vec<2>& at) {
      Simulation<2> s(bar(at, method, Lattice::cell_centred), steel("hypoelastic"), method);
      pull(s, 1e-3);
      s.run(1, {.progress = [](std::int64_t steps, double, double) { return steps < 60; }});
      CHECK(s.position(0).isApprox(s.reference_position(0), 1e-3));
      return displacements(s);
    };
    const auto here = moved({0, 0});
    for (const Offset& offset : offsets()) {
      CAPTURE(offset.name);
      CHECK(difference(moved(offset.at), here) < 1e-9);
    }
  }
}

TEST_CASE_TEMPLATE("bodies of one and three dimensions move in the same way wherever they lie", Dimension,
                   Dim<1>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const char* formulation : {"tl_displacement", "tl_bond_associated", "tl_stress_points"}) {
    CAPTURE(formulation);
    const auto moved = [&](double at) {
      const Vec<D> min = Vec<D>::Constant(at), max = Vec<D>::Constant(at + 0.7);
      Simulation<D> s(make_cloud(box<D>(min, max), {.dx = 0.1, .jitter = 0.2, .cells = true}),
                      make_material<D>("neo_hookean", {.E = E, .nu = 0.3, .density = 7850}),
                      {.formulation = formulation});
      s.clamp(s.face("x_min"));
      Vec<D> force = Vec<D>::Constant(-1e-3 * E);
      s.load(s.face("x_max"), force);
      s.run(1, {.progress = [](std::int64_t steps, double, double) { return steps < 30; }});
      std::vector<Vec<D>> u;
      for (std::size_t i = 0; i < s.size(); ++i) u.push_back(s.displacement(i));
      return u;
    };
    const auto here = moved(0);
    for (const double at : {1000.0, -5.4e6, 1e9}) {
      CAPTURE(at);
      CHECK(difference<D>(moved(at), here) < 1e-9);
    }
  }
}

TEST_CASE("symmetry planes far from the origin hold what lies on them") {
  for (const auto lattice : {Lattice::node_centred, Lattice::cell_centred})
    for (const char* formulation : {"tl_displacement", "tl_bond_associated", "ul_basic"}) {
      CAPTURE(static_cast<int>(lattice));
      CAPTURE(formulation);
      const Method method{.formulation = formulation, .support_dx = 2.4};
      const auto moved = [&](const Vec<2>& at) {
        Simulation<2> s(bar(at, method, lattice),
                        steel(formulation == std::string("ul_basic") ? "hypoelastic" : "linear_elastic"),
                        method);
        s.symmetry_plane(0, at[0] + 0.7);
        s.symmetry_plane(1, at[1]);
        s.load(s.face("x_min"), {-1e-3 * E * 0.3, 0});
        s.run(1, {.progress = [](std::int64_t steps, double, double) { return steps < 60; }});
        return displacements(s);
      };
      const auto here = moved({0, 0});
      for (const Offset& offset : offsets()) {
        CAPTURE(offset.name);
        CHECK(difference(moved(offset.at), here) < 1e-9);
      }
    }
}

TEST_CASE("small strains are as right as others") {
  for (const auto& [name, method] : total_lagrangian())
    for (const char* law : {"linear_elastic", "st_venant_kirchhoff", "corotated_svk", "neo_hookean"}) {
      CAPTURE(std::string(name));
      CAPTURE(law);
      const Cloud<2> cloud = bar({5e5, 5.4e6}, method);
      const auto per_strain = [&](double strain) {
        auto u = relaxed(cloud, method, strain, law);
        for (Vec<2>& v : u) v /= strain;
        return u;
      };
      const auto expected = per_strain(1e-6);
      for (const double strain : {1e-7, 1e-9, 1e-12})
        CHECK(difference(per_strain(strain), expected) < 1e-5);  // of the laws; the rest is the tolerance's
      std::vector<Vec<2>> exact;
      for (const Vec<2>& X : cloud.X) exact.emplace_back(X[0], -0.3 * X[1]);
      // The plain and the quadratic operator, and bonds, do not have uniform strain at the faces of a body.
      if (const std::string form(name); form != "standard" && form != "quadratic" && form != "bonds")
        CHECK(difference(expected, exact) < 2e-5);
    }
}

TEST_CASE("energies of small strains keep their digits") {
  for (const auto& [name, method] : total_lagrangian())
    for (const char* law : {"linear_elastic", "st_venant_kirchhoff", "neo_hookean"}) {
      CAPTURE(std::string(name));
      CAPTURE(law);
      constexpr double strain = 1e-9;
      Simulation<2> s(bar({1e9, 1e9}, method), steel(law), method);
      s.set_displacement([](const Vec<2>& X) { return Vec<2>(strain * (X[0] - 1e9), 0); });
      s.prepare();
      const double all = 0.5 * E / (1 - 0.09) * strain * strain * 0.7 * 0.3;
      if (name != std::string("standard")) CHECK(s.strain_energy() == doctest::Approx(all).epsilon(1e-5));
      CHECK(s.strain_energy() > 0.1 * all);
    }
}

TEST_CASE("what users see and say are positions in their own coordinates") {
  const Vec<2> at(5e5, 5.4e6);
  const Cloud<2> cloud = bar(at, {});
  CHECK(cloud.origin == at);
  Simulation<2> s(cloud, steel(), {});
  pull(s, 1e-3);
  std::size_t selected = 0;
  s.prescribe(
      [&](const Vec<2>& X) {
        CHECK((X.array() >= at.array()).all());
        selected += X[0] < at[0] + 0.05 && X[1] > at[1] + 0.25;
        return X[0] < at[0] + 0.05 && X[1] > at[1] + 0.25;
      },
      1, [&](const Vec<2>& X, double) { return 1e-6 * (X[1] - at[1]); });
  CHECK(selected == 1);
  s.set_displacement([&](const Vec<2>& X) { return Vec<2>(1e-3 * (X - at)); });
  s.set_velocity([&](const Vec<2>& X) { return Vec<2>(X - at); });
  s.prepare();
  const std::size_t last = s.size() - 1;
  CHECK((s.reference_position(0) - at).norm() < 1e-9);
  CHECK((s.reference_position(last) - at - Vec<2>(0.7, 0.3)).norm() < 2e-9);
  CHECK((s.position(last) - at - 1.001 * Vec<2>(0.7, 0.3)).norm() < 2e-9);
  CHECK((s.displacement(last) - 1e-3 * Vec<2>(0.7, 0.3)).norm() < 2e-12);
  CHECK((s.velocity(last) - Vec<2>(0.7, 0.3)).norm() < 2e-9);
  CHECK(s.displacement_at(at + Vec<2>(0.7, 0.3)) == s.displacement(last));
  CHECK((s.displacement_at(at + Vec<2>(0.33, 0.17)) - 1e-3 * Vec<2>(0.33, 0.17)).norm() < 1e-11);
  CHECK(on_face(cloud, "x_max")(at + Vec<2>(0.7, 0.1)));
  CHECK(!on_face(cloud, "x_max")(at + Vec<2>(0.6, 0.1)));
  CHECK(s.relax({.max_steps = 20000}).status == Status::ok);
  CHECK(s.displacement(24)[1] == doctest::Approx(3e-7).epsilon(1e-6));
}

TEST_CASE("messages name the user's coordinates") {
  Simulation<2> s(bar({1000, 2000}, {}), steel(), {});
  s.symmetry_plane(0, 1000.35);
  CHECK_THROWS_WITH_AS(s.prepare(), doctest::Contains("x = 1000.35 cuts the body"), InputError);
}

TEST_CASE("clouds that users fill far from the origin are brought nearer") {
  for (const Offset& offset : offsets()) {
    CAPTURE(offset.name);
    const Cloud<2> here = bar({0, 0}, {});
    Cloud<2> there = here;
    for (Vec<2>& X : there.X) X += offset.at;
    CHECK(difference(relaxed(there, {}), relaxed(here, {})) < 1e-9);
    const Simulation<2> s(there, steel(), {});
    for (std::size_t i = 0; i < s.size(); ++i)
      CHECK((s.reference_position(i) - there.X[i]).norm() <= coordinate_rounding(there.X[i].norm()));
  }
}

TEST_CASE("files with map coordinates are read to the digits that they have") {
  const auto file = std::filesystem::temp_directory_path() / "taut_offset.csv";
  {
    std::ofstream out(file);
    out << "x,y,volume\n";
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 8; ++i)
        out << 500000 + i / 10 << '.' << i % 10 << "05,540000" << j << ".005,0.01\n";
  }
  const Cloud<2> cloud = read_cloud<2>(file, 0.1);
  std::filesystem::remove(file);
  CHECK((cloud.origin - Vec<2>(500000.005, 5400000.005)).norm() < 1e-9);
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 8; ++i) CHECK(cloud.X[static_cast<std::size_t>(8 * j + i)] == Vec<2>(i / 10.0, j));
}

TEST_CASE("a lattice has its place at the origin, or none near it") {
  const Cloud<2> here = bar({0, 0}, {}), beside = bar({3, -4}, {});
  CHECK(beside.origin == Vec<2>::Zero());
  CHECK(beside.X[0] == Vec<2>(3, -4));
  for (const Offset& offset : offsets()) {
    CAPTURE(offset.name);
    const Cloud<2> there = bar(offset.at, {});
    CHECK(there.origin == offset.at);
    REQUIRE(there.size() == here.size());
    for (std::size_t i = 0; i < here.size(); ++i) {
      CHECK((there.X[i] - here.X[i]).norm() < 1e-15);
      CHECK(there.V[i] == doctest::Approx(here.V[i]).epsilon(1e-15));
    }
    CHECK(there.dx == here.dx);
  }
}

TEST_CASE("differences of rounded coordinates are the shortest decimals that these leave possible") {
  CHECK(coordinate_difference(500000.005, 500000) == 0.005);
  CHECK(coordinate_difference(5400000.05, 5400000) == 0.05);
  CHECK(coordinate_difference(-5399999.95, -5400000) == 0.05);
  CHECK(coordinate_difference(1e9 + 0.7, 1e9) == 0.7);
  CHECK(coordinate_difference(1e6 + 0.125, 1e6) == 0.125);
  CHECK(coordinate_difference(7.25, 7.25) == 0);
  // Nothing is lost of these.
  CHECK(coordinate_difference(0.3, 0.1) == 0.3 - 0.1);
  CHECK(coordinate_difference(1.0 / 3, 0) == 1.0 / 3);
  for (const double x : {1.0 / 3, 0.1234567890123, 2e-7})
    CHECK(std::abs(coordinate_difference(1000 + x, 1000) - x) <= coordinate_rounding(1000));
}
