#include <limits>
#include <taut/neighbors/pair_list_builder.hpp>

#include "clouds.hpp"

using namespace clouds;
using namespace taut;

namespace {

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN(),
                 infinity = std::numeric_limits<double>::infinity();
constexpr SearchMethod methods[] = {SearchMethod::cell_list, SearchMethod::kd_tree};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a coordinate that is not finite is named") {
  for (const SearchMethod method : methods) {
    auto p = random_cloud<3>(50);
    p.x[1][30] = not_a_number;
    p.x[2][40] = infinity;
    CHECK(message_of([&] { find_pairs(p.view(), 0.1, {method}); }) ==
          "particle 30: its y is nan; neighbours are defined for finite coordinates only");
    p.x[1][30] = 0;
    CHECK(message_of([&] { find_pairs(p.view(), 0.1, {method}); }) ==
          "particle 40: its z is inf; neighbours are defined for finite coordinates only");
    CHECK(contains(message_of([&] { locality_order(p.view(), 0.1); }), "particle 40: its z is inf"));
  }
}

TEST_CASE("a radius that cannot be one is refused") {
  const auto p = random_cloud<2>(20);
  for (const double radius : {0.0, -1.0, not_a_number, infinity, 1e-200}) {
    const std::string why = "a support radius is a finite length greater than 0 (1e-150 to 1e150)";
    CHECK(message_of([&] { find_pairs(p.view(), radius); }) == fmt::format("radius {}: {}", radius, why));
    std::vector<double> radii(20, 0.1);
    radii[13] = radius;
    CHECK(message_of([&] { find_pairs(p.view(), std::span<const double>(radii)); }) ==
          fmt::format("particle 13: its radius is {}; {}", radius, why));
    CHECK(contains(message_of([&] { locality_order(p.view(), radius); }), "the size of a cell"));
  }
  const std::vector<double> few(19, 0.1);
  CHECK(message_of([&] { find_pairs(p.view(), std::span<const double>(few)); }) ==
        "19 radii for 20 particles: each particle needs one");
  CHECK(message_of([&] { find_pairs(p.view(), std::span<const double>()); }) ==
        "0 radii for 20 particles: each particle needs one");
}

TEST_CASE("coincident particles are both named, the first of them where there are more") {
  for (const SearchMethod method : methods) {
    auto p = random_cloud<2>(30000);
    const auto lay = [&](Index a, Index b) {
      for (auto& c : p.x) c[a] = c[b];
    };
    lay(25011, 25010);
    lay(29000, 1500);
    p.x[0][1500] = p.x[0][29000] = 0.5;
    p.x[1][1500] = p.x[1][29000] = 0.25;
    lay(9000, 7000);
    for (const bool graded : {false, true}) {
      const std::vector<double> radii(30000, 0.01);
      const auto find = [&] {
        graded ? find_pairs(p.view(), std::span<const double>(radii), {method})
               : find_pairs(p.view(), 0.01, {method});
      };
      CHECK(message_of(find) ==
            "particles 1500 and 29000 coincide at (0.5, 0.25): remove one of them, or move overlapping "
            "bodies apart");
    }
  }
}

TEST_CASE("coincident particles of different rows are named") {
  for (const SearchMethod method : methods) {
    auto p = lattice<2>({100, 40});
    p.x[1][1250] = 13;  // onto the particle above
    for (const bool graded : {false, true}) {
      const std::vector<double> radii(4000, 2.1);
      CHECK(contains(message_of([&] {
                       graded ? find_pairs(p.view(), std::span<const double>(radii), {method})
                              : find_pairs(p.view(), 2.1, {method});
                     }),
                     "particles 1250 and 1350 coincide at (50, 13)"));
    }
  }
}

TEST_CASE("particles nearer than 1e-12 radii coincide, others do not") {
  for (const SearchMethod method : methods) {
    Points<1> p;
    p.x[0] = {0, 0.9e-12};
    CHECK(contains(message_of([&] { find_pairs(p.view(), 1.0, {method}); }),
                   "particles 0 and 1 coincide at (0)"));
    p.x[0] = {0, 1.1e-12};
    CHECK(find_pairs(p.view(), 1.0, {method}).pairs() == 2);
    p.x[0].assign(100, 3);
    CHECK(contains(message_of([&] { find_pairs(p.view(), 1.0, {method}); }),
                   "particles 0 and 1 coincide at (3)"));
  }
}

TEST_CASE("lists that an index cannot address are refused before they are made") {
  CHECK_NOTHROW(PairListBuilder::check_slots(2147483647.0, 1e6));
  CHECK(message_of([] { PairListBuilder::check_slots(2147483648.0, 1048576); }) ==
        "the pair list of 1048576 particles would need at least 2.15e+09 slots of eight pairs, and a 32-bit "
        "index "
        "counts 2147483647: use a smaller radius (this one gives each at least 1.64e+04 neighbours) or fewer "
        "particles");
  // 400 000 particles within one radius have 1.6e11 pairs: known from the cells, without a search.
  const auto p = random_cloud<1>(400000);
  CHECK(contains(message_of([&] { find_pairs(p.view(), 10.0); }),
                 "the pair list of 400000 particles would need"));
}
