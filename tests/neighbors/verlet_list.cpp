#include <taut/neighbors/verlet_list.hpp>

#include "clouds.hpp"

using namespace clouds;
using namespace taut;

TEST_CASE("a Verlet list is rebuilt when a particle has moved by half the skin") {
  auto p = lattice<2>({20, 20}, 0.1);
  VerletList<2> list(2.0, 0.2);
  CHECK(list.reach() == 2.4);
  CHECK(list.update(p.view()));
  CHECK(list.builds() == 1);
  CHECK(same_layout(list.pairs(), find_pairs(p.view(), 2.4)));
  CHECK_FALSE(list.update(p.view()));

  p.x[0][7] += 0.19;  // half the skin is 0.2
  CHECK_FALSE(list.update(p.view()));
  CHECK(list.largest_displacement() == doctest::Approx(0.19));
  p.x[1][7] += 0.1;
  CHECK(list.update(p.view()));
  CHECK(list.largest_displacement() == 0);
  CHECK(list.builds() == 2);
  CHECK(same_layout(list.pairs(), find_pairs(p.view(), 2.4)));
}

TEST_CASE("between rebuilds no pair within the radius is missing") {
  auto p = random_cloud<3>(400);
  VerletList<3> list(0.2, 0.3);
  std::mt19937_64 random(9);
  int kept = 0;
  for (int step = 0; step < 40; ++step) {
    kept += !list.update(p.view());
    for (const auto& [a, b] : brute_force(p, std::vector<double>(400, 0.2)))
      if (list.pairs().find(a, b) < 0) FAIL("missing ", a, " ", b, " in step ", step);
    for (auto& c : p.x)
      for (double& v : c) v += 0.01 * (2 * uniform(random) - 1);
  }
  CHECK(kept > 10);
  CHECK(list.builds() == 40 - kept);
}

TEST_CASE("a Verlet list follows the number of points") {
  VerletList<1> list(0.1, 0.1);
  CHECK(list.update(Points<1>().view()));
  CHECK(list.update(random_cloud<1>(10).view()));
  CHECK(list.update(random_cloud<1>(9).view()));
  CHECK(list.pairs().particles() == 9);
  CHECK_FALSE(list.update(random_cloud<1>(9).view()));
}

TEST_CASE("a Verlet list refuses what cannot be") {
  CHECK(message_of([] { VerletList<2>(0, 0.1); }) ==
        "radius 0: a support radius is a finite length greater than 0");
  CHECK(message_of([] { VerletList<2>(1, -0.1); }) ==
        "skin -0.1: a skin is a fraction of the radius, 0 or more (0.1 is usual)");
  auto p = random_cloud<2>(10);
  VerletList<2> list(0.5, 0.1);
  list.update(p.view());
  p.x[1][3] = std::nan("");
  CHECK(message_of([&] { list.update(p.view()); }) ==
        "particle 3: its y is nan; neighbours are defined for finite coordinates only");
}
