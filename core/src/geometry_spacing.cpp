#include <algorithm>
#include <array>
#include <cmath>
#include <nanoflann.hpp>
#include <taut/core/geometry.hpp>

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

double quantile(std::vector<double> values, double q) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

template <int D>
void grade_spacing(Cloud<D>& cloud) {
  constexpr std::size_t nearest =
      2 * D + 1;                // itself and what stands around: on a face, a particle inside as well
  constexpr double even = 1.6;  // jitter makes less of a difference than this
  cloud.spacing = {};
  if (cloud.size() <= nearest) return;
  const Points<D> points{cloud.X};
  const nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points<D>>, Points<D>, D,
                                            std::size_t>
      tree(D, points, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  std::vector<double> spacing(cloud.size());
#pragma omp parallel for schedule(static)
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    std::array<std::size_t, nearest> index{};
    std::array<double, nearest> squared{};
    tree.knnSearch(cloud.X[p].data(), nearest, index.data(), squared.data());
    // Shares of the body are cut in half on faces: the largest around is that of a particle inside.
    double volume = 0;
    for (const std::size_t b : index) volume = std::max(volume, cloud.V[b]);
    // Rows that are further apart than the particles in them must still see each other.
    spacing[p] = std::max(std::pow(volume, 1.0 / D), std::sqrt(squared[D]));
  }
  if (quantile(spacing, 0.98) < even * quantile(spacing, 0.02)) return;
  cloud.spacing = std::move(spacing);
}

template void grade_spacing<1>(Cloud<1>&);
template void grade_spacing<2>(Cloud<2>&);
template void grade_spacing<3>(Cloud<3>&);

}  // namespace taut
