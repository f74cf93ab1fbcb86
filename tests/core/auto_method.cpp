// What a method leaves open is chosen for the body.

#include <doctest/doctest.h>

#include <taut/taut.hpp>

using namespace taut;

namespace {

Method method_of(const Cloud<2>& cloud, const Method& method, const char* material = "neo_hookean") {
  return Simulation<2>(cloud, make_material<2>(material, {.E = 1e6, .nu = 0.3, .density = 1000}), method)
      .method();
}
const Shape<2> sheet = box<2>({0, 0}, {1, 0.5});

}  // namespace

TEST_CASE("a method that says nothing is stress points where there are cells") {
  const Cloud<2> lattice = make_cloud(sheet, {.dx = 0.1, .jitter = 0.2});
  CHECK(method_of(lattice, {}).formulation == "tl_stress_points");
  CHECK(method_of(lattice, {}).zero_energy_control == 1);
  CHECK(method_of(lattice, {.zero_energy_control = 0.5}).zero_energy_control == 0.5);
}

TEST_CASE(
    "a method that says nothing is compatible pairs where there are no cells, the kernel by where particles "
    "lie") {
  const Method nodes = method_of(make_cloud(sheet, {.dx = 0.1, .cells = false}), {});
  CHECK(nodes.formulation == "tl_displacement");
  CHECK(nodes.operators == "compatible");
  CHECK(nodes.kernel == "quadratic");
  CHECK(nodes.support_dx == 1.5);
  const Cloud<2> middles = make_cloud(sheet, {.dx = 0.1, .lattice = Lattice::cell_centred});
  CHECK(method_of(middles, {}).kernel == "lucy");
  Cloud<2> bare = middles;  // volumes alone tell as much
  bare.facets.clear();
  bare.body.reset();
  CHECK(method_of(bare, {}).operators == "compatible");
  CHECK(method_of(bare, {}).kernel == "lucy");
}

TEST_CASE(
    "a method that says something of pairs, or names its formulation, is what it says and plain in the "
    "rest") {
  const Cloud<2> lattice = make_cloud(sheet, {.dx = 0.1});
  const Method compatible = method_of(lattice, {.operators = "compatible"});
  CHECK(compatible.formulation == "tl_displacement");
  CHECK(compatible.operators == "compatible");
  CHECK(compatible.kernel == "wendland_c2");
  CHECK(compatible.support_dx == 1.5);
  CHECK(method_of(lattice, {.support_dx = 2.4}).operators == "corrected");
  CHECK(method_of(lattice, {.formulation = "tl_bond_associated"}).operators == "corrected");
}

TEST_CASE("a method that says nothing takes an updated form for stress rates") {
  const Method rates = method_of(make_cloud(sheet, {.dx = 0.1}), {}, "hypoelastic");
  CHECK(rates.formulation == "ul_artificial_stress");
  CHECK(rates.kernel == "sinc5");
  CHECK(rates.support_dx == 2.4);
}

TEST_CASE("a method that says nothing gets the support that irregular particles need") {
  const auto rows_apart = [](double apart) {
    Cloud<2> cloud;
    cloud.dx = 1;
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 8; ++i) {
        cloud.X.emplace_back(i, apart * j);
        cloud.V.push_back(apart);
      }
    return cloud;
  };
  // Rows come within reach, but next to nothing of the kernel is left there.
  CHECK(spanning_support(rows_apart(1.0)) == 1.5);
  CHECK(spanning_support(rows_apart(1.49)) == 1.7);
  CHECK(spanning_support(rows_apart(1.69)) == 2.0);
  CHECK(spanning_support(rows_apart(2.2)) == 2.4);
  CHECK(spanning_support(rows_apart(2.45)) == 2.8);
  // Out of reach altogether: not for auto to say.
  CHECK(spanning_support(rows_apart(4)) == 1.5);
  CHECK(method_of(rows_apart(1.49), {}).support_dx == 1.7);
  CHECK(method_of(rows_apart(1.49), {.operators = "compatible"}).support_dx == 1.5);
  Cloud<2> graded = rows_apart(1.69);
  graded.spacing.assign(graded.size(), 1.69);
  CHECK(spanning_support(graded) == 1.5);
}
