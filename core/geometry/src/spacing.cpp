#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nanoflann.hpp>
#include <numeric>
#include <span>
#include <taut/base/parallel.hpp>
#include <taut/geometry/spacing.hpp>

namespace taut {
namespace {

template <int D>
struct Points {
  const std::vector<Vec<D>>& X;
  std::size_t kdtree_get_point_count() const { return X.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t d) const { return X[i][static_cast<Eigen::Index>(d)]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

}  // namespace

namespace {
// f(p, indices, squared distances) for each point, of those among the k nearest that there are.
template <int D, class F>
void each_nearest(const std::vector<Vec<D>>& X, std::size_t k, F&& f) {
  const Points<D> points{X};
  const nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points<D>>, Points<D>, D>
      tree(D, points, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  constexpr std::size_t block = 1024;
  parallel_for((X.size() + block - 1) / block, true, [&](std::size_t b) {
    std::vector<std::uint32_t> index(k);
    std::vector<double> squared(k);
    for (std::size_t p = b * block; p < std::min((b + 1) * block, X.size()); ++p) {
      const std::size_t found = tree.knnSearch(X[p].data(), k, index.data(), squared.data());
      f(p, std::span(index).first(found), std::span(squared).first(found));
    }
  });
}
}  // namespace

template <int D>
std::vector<double> nearest_distances(const std::vector<Vec<D>>& X, int k) {
  const auto wanted = static_cast<std::size_t>(k) + 1;  // the first is the point itself
  std::vector<double> distance(X.size(), std::numeric_limits<double>::infinity());
  each_nearest<D>(X, wanted, [&](std::size_t p, auto, auto squared) {
    if (squared.size() == wanted) distance[p] = std::sqrt(squared.back());
  });
  return distance;
}

template <int D>
std::vector<Index> nearest_points(const std::vector<Vec<D>>& X, int k) {
  const auto wanted = static_cast<std::size_t>(k);
  std::vector<Index> nearest(X.size() * wanted, no_particle);
  each_nearest<D>(X, wanted, [&](std::size_t p, auto index, auto) {
    for (std::size_t j = 0; j < index.size(); ++j) nearest[p * wanted + j] = static_cast<Index>(index[j]);
  });
  return nearest;
}

template <int D>
double median_distance(const std::vector<Vec<D>>& X) {
  std::vector<double> nearest = nearest_distances<D>(X, 1);
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

double spacing_by_volume(std::vector<double> V, int dimension) {
  std::sort(V.begin(), V.end());
  const double half = std::accumulate(V.begin(), V.end(), 0.0) / 2;
  double sum = 0;
  for (const double v : V) {
    sum += v;
    if (sum > half) return std::pow(v, 1.0 / dimension);
  }
  return std::pow(V.back(), 1.0 / dimension);
}

#define TAUT_INSTANTIATE(D)                                                           \
  template std::vector<double> nearest_distances<D>(const std::vector<Vec<D>>&, int); \
  template std::vector<Index> nearest_points<D>(const std::vector<Vec<D>>&, int);     \
  template double median_distance<D>(const std::vector<Vec<D>>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
