#include "clouds.hpp"

using namespace clouds;
using namespace taut;

TEST_CASE_TEMPLATE_DEFINE("pairs are those of the definition", Dimension, pairs_by_definition) {
  constexpr int D = Dimension::value;
  std::array<int, D> count;
  count.fill(D == 1 ? 300 : D == 2 ? 19 : 9);
  const double radius = D == 1 ? 0.02 : D == 2 ? 0.1 : 0.2;

  SUBCASE("random") { check_against_brute_force(random_cloud<D>(700), radius); }
  SUBCASE("lattice, radius between shells") { check_against_brute_force(lattice<D>(count), 2.1); }
  SUBCASE("lattice, radius on a shell") {
    const auto p = lattice<D>(count);
    check_against_brute_force(p, 2.0);
    for (const auto& [a, b] : pairs_of(find_pairs(p.view(), 1.0)))
      FAIL("a distance of 1 is not below 1: ", a, b);
  }
  SUBCASE("lattice of rounded spacing, radius on a shell") {
    auto p = lattice<D>(count);
    for (auto& c : p.x)
      for (double& v : c) v *= 0.1;
    check_against_brute_force(p, 0.2);
    check_against_brute_force(p, 0.3);
  }
  SUBCASE("lattice, shuffled") {
    const auto p = lattice<D>(count);
    check_against_brute_force(p.reordered(shuffled<D>(p.n())), 1.5);
  }
  SUBCASE("jittered") { check_against_brute_force(lattice<D>(count, 0.3), 2.0); }
  SUBCASE("clusters") { check_against_brute_force(clusters<D>(400), 0.1); }
  SUBCASE("far from the origin") {
    auto p = random_cloud<D>(500);
    p.shift(1e6);
    check_against_brute_force(p, radius);
    p.shift(-3e6);
    check_against_brute_force(p, radius);
  }
  SUBCASE("a far outlier") {
    auto p = random_cloud<D>(300);
    std::array<double, D> far;
    far.fill(1e9);
    p.add(far);
    far.fill(-1e300);
    p.add(far);
    check_against_brute_force(p, radius);
  }
  SUBCASE("all beyond any cell number") {
    auto p = random_cloud<D>(300);
    for (auto& c : p.x)
      for (double& v : c) v *= 1e40;
    check_against_brute_force(p, 1e-20);
    check_against_brute_force(p, radius * 1e40);
  }
  SUBCASE("a diagonal line") {
    Points<D> p;
    for (int i = 0; i < 400; ++i) {
      std::array<double, D> at;
      for (int d = 0; d < D; ++d) at[d] = (d % 2 ? -1.0 : 1.0) * i;
      p.add(at);
    }
    check_against_brute_force(p, 2.5 * std::sqrt(D));
  }
  SUBCASE("collinear and coplanar") {
    auto p = random_cloud<D>(300);
    for (int d = 1; d < D; ++d) {
      std::fill(p.x[d].begin(), p.x[d].end(), 0.25);
      check_against_brute_force(p, radius);
    }
    p = random_cloud<D>(300);
    if (D == 3) std::fill(p.x[0].begin(), p.x[0].end(), -3);
    check_against_brute_force(p, radius);
  }
  SUBCASE("the box is thinner than a cell") { check_against_brute_force(random_cloud<D>(60), 5.0); }
  SUBCASE("a radius below every distance") { check_against_brute_force(lattice<D>(count), 1e-9); }
  SUBCASE("on borders of cells") {
    const auto p = lattice<D>(count);
    for (const double r : {1.0, 2.0, std::nextafter(1.0, 2.0), std::nextafter(2.0, 0.0)})
      check_against_brute_force(p, r);
  }
  SUBCASE("few particles") {
    for (Index n = 0; n <= 20; ++n) {
      check_against_brute_force(random_cloud<D>(n, 5), 0.5);
      check_against_brute_force(random_cloud<D>(n, 6), 10.0);
    }
  }
}
TEST_CASE_TEMPLATE_INVOKE(pairs_by_definition, std::integral_constant<int, 1>, std::integral_constant<int, 2>,
                          std::integral_constant<int, 3>);

TEST_CASE_TEMPLATE_DEFINE("pairs with a radius a particle", Dimension, graded_pairs) {
  constexpr int D = Dimension::value;
  const double radius = D == 1 ? 0.02 : D == 2 ? 0.1 : 0.2;
  std::mt19937_64 random(3);
  const auto radii_for = [&](Index n, double ratio) {
    std::vector<double> radii;
    for (Index i = 0; i < n; ++i)
      radii.push_back(radius * std::pow(ratio, uniform(random)) / std::sqrt(ratio));
    return radii;
  };
  SUBCASE("spread at random") {
    for (const double ratio : {1.0, 4.0, 1000.0}) {
      const auto p = random_cloud<D>(400);
      check_against_brute_force(p, radii_for(p.n(), ratio));
    }
  }
  SUBCASE("graded along x") {
    auto p = random_cloud<D>(500);
    std::vector<double> radii;
    for (double& x : p.x[0]) {
      x *= x;
      radii.push_back(radius * (0.25 + x));
    }
    check_against_brute_force(p, radii);
  }
  SUBCASE("one giant, one outlier") {
    auto p = random_cloud<D>(300);
    std::array<double, D> far;
    far.fill(1e9);
    p.add(far);
    auto radii = radii_for(p.n(), 2);
    radii[17] = 3;
    check_against_brute_force(p, radii);
    radii[17] = 1e10;
    check_against_brute_force(p, radii);
  }
  SUBCASE("few particles") {
    for (Index n = 1; n <= 20; ++n) check_against_brute_force(random_cloud<D>(n, 4), radii_for(n, 100));
  }
  SUBCASE("equal radii give the list of the single radius") {
    const auto p = random_cloud<D>(300);
    const std::vector<double> radii(300, radius);
    CHECK(same_layout(find_pairs(p.view(), std::span(radii)), find_pairs(p.view(), radius)));
  }
  SUBCASE("no particles") { CHECK(find_pairs(Points<D>().view(), std::span<const double>()).pairs() == 0); }
}
TEST_CASE_TEMPLATE_INVOKE(graded_pairs, std::integral_constant<int, 1>, std::integral_constant<int, 2>,
                          std::integral_constant<int, 3>);

TEST_CASE("rows are tested slot by slot, with the same result") {
  // Rows longer than a slice and its neighbours, whose ends lie within slices.
  for (const double jitter : {0.0, 0.2, 0.45}) {
    const auto block = lattice<3>({43, 6, 6}, jitter);
    for (const double radius : {1.2, 2.1, 3.0}) check_against_brute_force(block, radius);
    std::vector<double> radii;
    for (const double x : block.x[0]) radii.push_back(1.2 + 0.04 * x);
    check_against_brute_force(block, radii);
  }
  check_against_brute_force(lattice<2>({61, 20}, 0.3), 2.6);
  // Rows that close in on each other without losing their order, so that no two are alike.
  auto fan = lattice<2>({64, 20});
  for (std::size_t i = 0; i < fan.x[0].size(); ++i) {
    fan.x[0][i] *= 0.3 + 0.05 * fan.x[1][i];
    fan.x[1][i] *= 0.2 + 0.01 * fan.x[0][i];
  }
  check_against_brute_force(fan, 1.3);
}

TEST_CASE("memory follows the particles and pairs, not the extent") {
  auto p = random_cloud<3>(2000);
  const std::size_t compact = find_pairs(p.view(), 0.1).bytes();
  p.add({1e9, 1e9, -1e9});
  for (const SearchMethod method : {SearchMethod::cell_list, SearchMethod::kd_tree}) {
    const PairList list = find_pairs(p.view(), 0.1, {method});
    CHECK(list.bytes() < compact + 200);
    CHECK(list.bytes() < 100 * static_cast<std::size_t>(p.n()) + 40 * static_cast<std::size_t>(list.pairs()));
  }
}

TEST_CASE("names of the search methods") {
  CHECK(search_method("cell_list") == SearchMethod::cell_list);
  CHECK(search_method("kd_tree") == SearchMethod::kd_tree);
  CHECK(message_of([] { search_method("octree"); }) ==
        "unknown neighbour search \"octree\"; valid: cell_list, kd_tree");
}
