#include "clouds.hpp"

using namespace clouds;
using namespace taut;

TEST_CASE_TEMPLATE("a filtered list has the pairs that are kept, in their order", Dimension,
                   std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
  constexpr int D = Dimension::value;
  const auto p = random_cloud<D>(5000);
  const PairList all = find_pairs(p.view(), 0.12);
  const auto keep = [](Index a, Index b) { return (a + b) % 3 != 0 && a / 100 != 7 && b / 100 != 7; };
  PairList some = find_pairs(p.view(), 0.12);
  filter_pairs(some, keep);
  std::int64_t pairs = 0, faults = 0;
  for (Index a = 0; a < p.n(); ++a) {
    std::vector<Index> expected, found;
    all.for_each(a, [&](Index b, std::int64_t, int) {
      if (keep(a, b)) expected.push_back(b);
    });
    some.for_each(a, [&](Index b, std::int64_t k, int lane) {
      found.push_back(b);
      faults += some.find(a, b) != k || !(some.mask(k) >> lane & 1);
    });
    faults += expected != found;
    pairs += static_cast<std::int64_t>(found.size());
  }
  CHECK(faults == 0);
  CHECK(some.pairs() == pairs);
  CHECK(pairs < all.pairs());
  CHECK(some.slots() < all.slots());
  for (std::int64_t k = 0; k < some.slots(); ++k) CHECK(some.mask(k) != 0);

  PairList none = find_pairs(p.view(), 0.12);
  filter_pairs(none, [](Index, Index) { return false; });
  CHECK(none.pairs() == 0);
  CHECK(none.slots() == 0);
  PairList same = find_pairs(p.view(), 0.12);
  filter_pairs(same, [](Index, Index) { return true; });
  CHECK(same_layout(same, all));
}

TEST_CASE("points that coincide are pairs where they are let") {
  auto p = random_cloud<2>(500);
  for (std::size_t i = 0; i < 100; ++i)
    for (std::size_t d = 0; d < 2; ++d) p.x[d][499 - i] = p.x[d][i];
  CHECK_THROWS_WITH(find_pairs(p.view(), 0.15), doctest::Contains("coincide"));
  for (const SearchMethod method : {SearchMethod::cell_list, SearchMethod::kd_tree}) {
    PairList list = find_pairs(p.view(), 0.15, {method, true});
    for (Index i = 0; i < 100; ++i) {
      CHECK(list.find(i, 499 - i) >= 0);
      CHECK(list.find(499 - i, i) >= 0);
      CHECK(list.find(i, i) < 0);
    }
  }
}
