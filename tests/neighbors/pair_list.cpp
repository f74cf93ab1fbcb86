#include <omp.h>

#include "clouds.hpp"

using namespace clouds;
using namespace taut;

TEST_CASE("a default pair list is empty") {
  const PairList list;
  CHECK(list.particles() == 0);
  CHECK(list.pairs() == 0);
  CHECK(list.slots() == 0);
  CHECK(list.contiguous_fraction() == 0);
}

TEST_CASE("for_each visits each neighbour once, with its slot and lane") {
  const auto p = random_cloud<2>(333);
  const PairList list = find_pairs(p.view(), 0.15);
  std::int64_t visited = 0, faults = 0;
  for (Index a = 0; a < p.n(); ++a) {
    std::set<Index> seen;
    list.for_each(a, [&](Index b, std::int64_t k, int lane) {
      const bool fine = seen.insert(b).second && lane == a % lanes && (list.mask(k) >> lane & 1) == 1 &&
                        list.find(a, b) == k && list.find(b, a) >= 0;
      faults += !fine;
      ++visited;
    });
    for (Index b = 0; b < p.n(); ++b) faults += (seen.count(b) == 0) != (list.find(a, b) == -1);
  }
  CHECK(faults == 0);
  CHECK(visited == list.pairs());
  CHECK(list.find(-1, 0) == -1);
  CHECK(list.find(p.n(), 0) == -1);
}

TEST_CASE("gathered slots are packed: the longest lane fills all of a slice's") {
  const auto p = random_cloud<3>(500).reordered(shuffled<3>(500));
  const PairList list = find_pairs(p.view(), 0.2);
  for (Index s = 0; s < list.slices(); ++s) {
    unsigned full = 0xff;
    for (std::int64_t k = list.gathered(s); k < list.begin(s + 1); ++k) full &= list.mask(k);
    if (list.gathered(s) < list.begin(s + 1)) CHECK(full != 0);
  }
}

TEST_CASE("on lattices slots are contiguous and full") {
  const auto cube = lattice<3>({40, 40, 40});
  const PairList list = find_pairs(cube.view(), 1.5);
  check_invariants(list);
  CHECK(list.contiguous_fraction() > 0.99);
  CHECK(static_cast<double>(list.pairs()) > 0.9 * static_cast<double>(lanes * list.slots()));

  // 21 is no multiple of eight: slices run over the ends of rows.
  const auto odd = lattice<3>({21, 21, 21});
  CHECK(find_pairs(odd.view(), 1.5).contiguous_fraction() > 0.95);
  const auto plate = lattice<2>({100, 30});
  CHECK(find_pairs(plate.view(), 2.4).contiguous_fraction() > 0.95);
  const auto rod = lattice<1>({1000});
  CHECK(find_pairs(rod.view(), 3.1).contiguous_fraction() > 0.95);
  // A lattice that jitter has moved keeps most of it.
  const auto jittered = lattice<3>({24, 24, 24}, 0.15);
  CHECK(find_pairs(jittered.view(), 1.5).contiguous_fraction() > 0.7);
}

TEST_CASE("the list has the same bits for any number of threads") {
  const int threads = omp_get_max_threads();
  const auto p = random_cloud<3>(9000);
  std::vector<double> radii(9000);
  for (std::size_t i = 0; i < radii.size(); ++i) radii[i] = 0.05 * (1 + p.x[0][i]);
  for (const SearchMethod method : {SearchMethod::cell_list, SearchMethod::kd_tree}) {
    omp_set_num_threads(1);
    const PairList one = find_pairs(p.view(), 0.07, {method});
    const PairList one_graded = find_pairs(p.view(), std::span<const double>(radii), {method});
    for (const int n : {2, 3}) {
      omp_set_num_threads(n);
      CHECK(same_layout(one, find_pairs(p.view(), 0.07, {method})));
      CHECK(same_layout(one_graded, find_pairs(p.view(), std::span<const double>(radii), {method})));
    }
  }
  omp_set_num_threads(threads);
}
