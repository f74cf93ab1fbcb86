#include <algorithm>
#include <array>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/base/small_solve.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/neighbors/search.hpp>
#include <vector>

namespace taut {

namespace {

constexpr std::array<double, 5> supports = {1.5, 1.7, 2.0, 2.4, 2.8};
constexpr double thin = 0.015;

// Whether a particle's neighbours within `support` span the space.
template <int D>
bool spans(const Cloud<D>& cloud, const PairList& pairs, Index a, double support) {
  const auto spacing = [&](Index i) {
    return cloud.spacing.empty() ? cloud.dx : cloud.spacing[static_cast<std::size_t>(i)];
  };
  Mat<D> moments = Mat<D>::Zero();
  pairs.for_each(a, [&](Index b, std::int64_t, int) {
    const Vec<D> X = cloud.X[static_cast<std::size_t>(b)] - cloud.X[static_cast<std::size_t>(a)];
    const double q = X.norm() / (support * std::max(spacing(a), spacing(b)));
    if (q < 1) moments += (1 - q) * (1 - q) * X * X.transpose();
  });
  return symmetric_eigen<D>(moments).values[0] > thin * moments.trace();
}

}  // namespace

template <int D>
double spanning_support(const Cloud<D>& cloud) {
  if (cloud.body || cloud.size() == 0) return supports.front();
  const auto n = static_cast<Index>(cloud.size());
  Field X(cloud.size(), D);
  std::vector<double> radii(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    X.template set_vec<D>(i, cloud.X[i]);
    radii[i] = supports.back() * (cloud.spacing.empty() ? cloud.dx : cloud.spacing[i]);
  }
  PairList pairs;
  try {
    pairs = find_pairs<D>(points_of<D>(X, n), radii);
  } catch (const InputError&) {
    return supports.front();  // said by what makes the particles
  }
  std::size_t needed = 0;
  for (Index a = 0; a < n; ++a)
    while (!spans(cloud, pairs, a, supports[needed]))
      if (++needed == supports.size()) return supports.front();
  return supports[needed];
}

template double spanning_support<1>(const Cloud<1>&);
template double spanning_support<2>(const Cloud<2>&);
template double spanning_support<3>(const Cloud<3>&);

}  // namespace taut
