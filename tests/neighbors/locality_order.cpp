#include <omp.h>

#include "clouds.hpp"

using namespace clouds;
using namespace taut;

namespace {

std::vector<Index> identity(Index n) {
  std::vector<Index> order;
  for (Index i = 0; i < n; ++i) order.push_back(i);
  return order;
}

bool is_permutation(std::vector<Index> order) {
  std::sort(order.begin(), order.end());
  return order == identity(static_cast<Index>(order.size()));
}

// Mean distance in memory of neighbours: what locality is about.
template <int D>
double spread(const Points<D>& p, double radius) {
  double sum = 0;
  const PairList list = find_pairs(p.view(), radius);
  for (const auto& [a, b] : pairs_of(list)) sum += std::abs(a - b);
  return sum / static_cast<double>(list.pairs());
}

}  // namespace

TEST_CASE("lattices are put in lexicographic order, the first coordinate fastest") {
  const auto cube = lattice<3>({7, 6, 5});
  CHECK(locality_order(cube.view(), 2.4) == identity(cube.n()));
  const auto mixed = shuffled<3>(cube.n());
  const auto order = locality_order(cube.reordered(mixed).view(), 2.4);
  for (Index i = 0; i < cube.n(); ++i)
    CHECK(mixed[static_cast<std::size_t>(order[static_cast<std::size_t>(i)])] == i);

  auto plate = lattice<2>({40, 9});
  std::mt19937_64 random(2);
  for (auto& c : plate.x)
    for (double& v : c) v = 0.1 * v + 1e-15 * uniform(random);  // rounding noise
  CHECK(locality_order(plate.view(), 0.24) == identity(plate.n()));
  plate.shift(12.3);
  CHECK(locality_order(plate.view(), 0.24) == identity(plate.n()));
}

TEST_CASE("a lattice may have holes, thin parts and an outlier") {
  const auto full = lattice<2>({60, 60});
  Points<2> ring;
  for (Index i = 0; i < full.n(); ++i) {
    const double r = std::hypot(full.x[0][i] - 29.5, full.x[1][i] - 29.5);
    if (r > 27 && r < 30) ring.add({full.x[0][i], full.x[1][i]});
  }
  ring.add({1e9, 1e9});
  CHECK(locality_order(ring.view(), 1.5) == identity(ring.n()));
}

TEST_CASE("a lattice that jitter has moved keeps its rows") {
  for (const double jitter : {0.02, 0.2, 0.4}) {
    const auto cube = lattice<3>({12, 12, 12}, jitter);
    const auto order = locality_order(cube.reordered(shuffled<3>(cube.n())).view(), 1.6);
    CHECK(cube.reordered(shuffled<3>(cube.n())).reordered(order).x == cube.x);
  }
  // Spheres have rows of different lengths, hexagonal lattices rows that are shifted.
  Points<2> hexagonal;
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20 + j; ++i) hexagonal.add({i + 0.5 * (j % 2), std::sqrt(0.75) * j});
  CHECK(locality_order(hexagonal.view(), 1.5) == identity(hexagonal.n()));
}

TEST_CASE("a line follows its coordinate") {
  const auto p = random_cloud<1>(500);
  const auto order = locality_order(p.view(), 0.01);
  CHECK(is_permutation(order));
  const auto sorted = p.reordered(order);
  CHECK(std::is_sorted(sorted.x[0].begin(), sorted.x[0].end()));
}

TEST_CASE_TEMPLATE("other clouds follow a space-filling curve", Dimension, std::integral_constant<int, 2>,
                   std::integral_constant<int, 3>) {
  constexpr int D = Dimension::value;
  auto p = random_cloud<D>(4000);
  const double radius = D == 2 ? 0.04 : 0.12, gain = D == 2 ? 0.15 : 0.3;
  const auto order = locality_order(p.view(), radius);
  CHECK(is_permutation(order));
  CHECK(spread(p.reordered(order), radius) < gain * spread(p, radius));

  // Outliers do not blunt it.
  std::array<double, D> far;
  far.fill(-1e9);
  p.add(far);
  far.fill(1e300);
  p.add(far);
  const auto with_outliers = locality_order(p.view(), radius);
  CHECK(is_permutation(with_outliers));
  CHECK(spread(p.reordered(with_outliers), radius) < gain * spread(p, radius));
}

TEST_CASE_TEMPLATE("consecutive cells of the curve are neighbours", Dimension, std::integral_constant<int, 2>,
                   std::integral_constant<int, 3>) {
  constexpr int D = Dimension::value;
  std::array<int, D> count;
  count.fill(D == 2 ? 32 : 8);
  auto p = lattice<D>(count, 0.49);  // one point a cell, and no rows any more
  p.shift(0.5);
  const auto order = locality_order(p.view(), 1.0);
  REQUIRE(is_permutation(order));
  const auto along = p.reordered(order);
  for (std::size_t i = 1; i < order.size(); ++i) {
    double steps = 0;
    for (int d = 0; d < D; ++d) steps += std::abs(std::floor(along.x[d][i]) - std::floor(along.x[d][i - 1]));
    CHECK(steps == 1);
  }
}

TEST_CASE_TEMPLATE("crowded cells follow the curve too", Dimension, std::integral_constant<int, 2>,
                   std::integral_constant<int, 3>) {
  constexpr int D = Dimension::value;
  const auto p = random_cloud<D>(4000);
  const double radius = D == 2 ? 0.04 : 0.12;
  const double suited = spread(p.reordered(locality_order(p.view(), radius)), radius);
  CHECK(spread(p.reordered(locality_order(p.view(), 8 * radius)), radius) < 1.1 * suited);
}

TEST_CASE("the order depends on where points are, not on how they came") {
  const auto p = random_cloud<3>(1000);
  const auto mixed = p.reordered(shuffled<3>(1000));
  CHECK(p.reordered(locality_order(p.view(), 0.2)).x == mixed.reordered(locality_order(mixed.view(), 0.2)).x);
}

TEST_CASE("the order is the same for any number of threads") {
  const int threads = omp_get_max_threads();
  const auto p = random_cloud<3>(9000);
  omp_set_num_threads(1);
  const auto one = locality_order(p.view(), 0.05);
  omp_set_num_threads(3);
  CHECK(locality_order(p.view(), 0.05) == one);
  omp_set_num_threads(threads);
}

TEST_CASE("a diagonal line of more cells than the key has bits for") {
  Points<3> p;
  for (int i = 0; i < 3000; ++i) p.add({1e7 * i, 1e7 * i, 1e7 * i});
  const auto order = locality_order(p.view(), 1.0);
  CHECK(is_permutation(order));
  CHECK(std::is_sorted(order.begin(), order.end()));
}

TEST_CASE("orders of no point and of one") {
  CHECK(locality_order(Points<2>().view(), 1.0).empty());
  CHECK(locality_order(random_cloud<2>(1).view(), 1.0) == identity(1));
}

TEST_CASE("large planes of a lattice are cut into blocks of rows") {
  const auto block = lattice<3>({100, 90, 4});
  const auto sorted = block.reordered(locality_order(block.view(), 2.1));
  // Rows stay whole, and the next plane comes before the rest of this one.
  CHECK(std::is_sorted(sorted.x[0].begin(), sorted.x[0].begin() + 100));
  const auto next = std::find(sorted.x[2].begin(), sorted.x[2].end(), 1.0) - sorted.x[2].begin();
  CHECK(next % 100 == 0);
  CHECK(next > 1000);
  CHECK(next < 2000);
  CHECK(find_pairs(sorted.view(), 2.1).contiguous_fraction() > 0.97);
}
