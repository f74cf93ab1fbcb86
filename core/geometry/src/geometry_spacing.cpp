#include <algorithm>
#include <taut/base/powers.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/geometry/spacing.hpp>

namespace taut {

namespace {

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
  const std::vector<Index> around = nearest_points<D>(cloud.X, static_cast<int>(nearest));
  std::vector<double> spacing(cloud.size());
  for (std::size_t p = 0; p < cloud.size(); ++p) {
    const Index* index = around.data() + p * nearest;
    // Shares of the body are cut in half on faces: the largest around is that of a particle inside.
    double volume = 0;
    for (std::size_t k = 0; k < nearest; ++k)
      volume = std::max(volume, cloud.V[static_cast<std::size_t>(index[k])]);
    // Rows that are further apart than the particles in them must still see each other.
    spacing[p] =
        std::max(edge_of<D>(volume), (cloud.X[static_cast<std::size_t>(index[D])] - cloud.X[p]).norm());
  }
  if (quantile(spacing, 0.98) < even * quantile(spacing, 0.02)) return;
  cloud.spacing = std::move(spacing);
}

template void grade_spacing<1>(Cloud<1>&);
template void grade_spacing<2>(Cloud<2>&);
template void grade_spacing<3>(Cloud<3>&);

}  // namespace taut
