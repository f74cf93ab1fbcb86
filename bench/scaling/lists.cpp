#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <scaling/body.hpp>
#include <scaling/lists.hpp>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/nanoflann.hpp>
#include <tuple>

namespace taut::bench {
namespace {

constexpr double neighbours = 32;

/// Spacing and radius of a point at x in a cube whose spacing grows fourfold along it.
double grading(double x) { return std::pow(4.0, x); }

std::vector<Vec<3>> graded_points(std::int64_t n) {
  std::mt19937_64 random(5);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  std::vector<Vec<3>> points(static_cast<std::size_t>(n));
  // Points of density 4^(-3 x): inverse of the integral of it.
  for (Vec<3>& p : points)
    p = {-std::log(1 - uniform() * (1 - 1.0 / 64)) / std::log(64.0), uniform(), uniform()};
  return points;
}

}  // namespace

PointView<3> ListCloud::view() const {
  return {{X.component(0), X.component(1), X.component(2)}, static_cast<Index>(size())};
}

const std::vector<std::string>& list_clouds() {
  static const std::vector<std::string> all = {"lattice", "jittered", "graded"};
  return all;
}

ListCloud list_cloud(std::string_view kind, std::int64_t points) {
  ListCloud cloud;
  cloud.name = kind;
  std::vector<Vec<3>> X;
  double coarsest = 0;
  if (kind == "graded") {
    X = graded_points(points);
    // Mean spacing at x = 0, where there are n ln(64) / (1 - 1/64) points a unit of volume.
    const double density = static_cast<double>(points) * std::log(64.0) / (1 - 1.0 / 64);
    const double radius = std::cbrt((neighbours + 1) / density * 3 / (4 * M_PI));
    cloud.radii.reserve(X.size());
    coarsest = 4 * radius;
  } else {
    const auto arrangement = kind == "jittered" ? Arrangement::jittered : Arrangement::lattice;
    if (kind != to_string(arrangement))
      throw InputError(fmt::format("unknown cloud \"{}\"; valid: {}", kind, join_names(list_clouds())));
    Cloud<3> c = cube<3>(points, arrangement);
    coarsest = neighbourhood<3>(static_cast<int>(neighbours), arrangement).support_dx * c.dx;
    cloud.radii = {coarsest};
    X = std::move(c.X);
  }
  Field given(X.size(), 3);
  for (std::size_t i = 0; i < X.size(); ++i) given.set_vec<3>(i, X[i]);
  cloud.X = std::move(given);
  const std::vector<Index> order = locality_order<3>(cloud.view(), coarsest);
  for (std::size_t i = 0; i < X.size(); ++i) cloud.X.set_vec<3>(i, X[static_cast<std::size_t>(order[i])]);
  if (kind == "graded")
    for (std::size_t i = 0; i < X.size(); ++i)
      cloud.radii.push_back(coarsest / 4 * grading(cloud.X.component(0)[i]));
  return cloud;
}

PairList taut_list(const ListCloud& cloud) {
  return cloud.graded() ? find_pairs<3>(cloud.view(), std::span<const double>(cloud.radii))
                        : find_pairs<3>(cloud.view(), cloud.radii[0]);
}

namespace {

struct Adaptor {
  PointView<3> points;
  std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points.n); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const { return points.x[d][i]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Adaptor>, Adaptor, 3, Index>;

}  // namespace

SearchedRows nanoflann_lists(const ListCloud& cloud, int threads) {
  const Adaptor adaptor{cloud.view()};
  const Tree tree(3, adaptor, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  SearchedRows result;
  result.pieces.resize(static_cast<std::size_t>(threads));
  ParallelError error;
#pragma omp parallel num_threads(threads)
  error.guard([&] {
    const auto t = static_cast<std::size_t>(omp_get_thread_num()),
               all = static_cast<std::size_t>(omp_get_num_threads());
    SearchedRows::Piece& piece = result.pieces[t];
    const std::size_t last = cloud.size() * (t + 1) / all;
    piece.first = cloud.size() * t / all;
    piece.row.reserve(last - piece.first + 1);
    piece.neighbour.reserve((last - piece.first) * static_cast<std::size_t>(neighbours));
    std::vector<detail::FoundPoint<Index, double>> found;
    const detail::SearchParameters parameters = detail::unsorted_search();
    for (std::size_t i = piece.first; i < last; ++i) {
      const double point[3] = {cloud.X.component(0)[i], cloud.X.component(1)[i], cloud.X.component(2)[i]};
      std::ignore = tree.radiusSearch(point, cloud.radius(i) * cloud.radius(i), found, parameters);
      for (const auto& [b, r2] : found)
        if (b != static_cast<Index>(i)) piece.neighbour.push_back(b);
      piece.row.push_back(piece.neighbour.size());
    }
  });
  error.rethrow();
  return result;
}

std::size_t SearchedRows::pairs() const {
  std::size_t sum = 0;
  for (const Piece& piece : pieces) sum += piece.neighbour.size();
  return sum;
}

std::size_t pairs_within_own_radius(const ListCloud& cloud, const PairList& list) {
  std::size_t pairs = 0;
  for (std::size_t a = 0; a < cloud.size(); ++a)
    list.for_each(static_cast<Index>(a), [&](Index b, std::int64_t, int) {
      double r2 = 0;
      for (int d = 0; d < 3; ++d) {
        const double dx = cloud.X.component(d)[a] - cloud.X.component(d)[b];
        r2 += dx * dx;
      }
      pairs += r2 < cloud.radius(a) * cloud.radius(a);
    });
  return pairs;
}

}  // namespace taut::bench
