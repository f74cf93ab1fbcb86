#include <Eigen/LU>
#include <cmath>
#include <scaling/baseline.hpp>
#include <taut/base/fields.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/neighbors/search.hpp>

namespace taut::bench {

CompressedPairs compressed_pairs(const Cloud<3>& cloud, const Method& method) {
  const std::size_t n = cloud.size();
  const double support = method.support_dx * cloud.dx;
  const Kernel kernel(method.kernel, 3);
  const double h = support / kernel.radius_factor(), weight = std::pow(cloud.dx, 6);

  Field X(n, 3);
  for (std::size_t i = 0; i < n; ++i) X.set_vec<3>(i, cloud.X[i]);
  const PointView<3> view = points_of<3>(X, static_cast<Index>(n));
  CompressedPairs p;
  p.id = locality_order<3>(view, support);
  for (std::size_t i = 0; i < n; ++i) X.set_vec<3>(i, cloud.X[static_cast<std::size_t>(p.id[i])]);
  const PairList list = find_pairs<3>(view, support);

  p.row.resize(n + 1);
  p.neighbour.resize(static_cast<std::size_t>(list.pairs()));
  p.gradient.resize(p.neighbour.size());
  p.M.resize(n);
  for (std::size_t a = 0; a < n; ++a) {
    p.row[a + 1] = p.row[a];
    list.for_each(static_cast<Index>(a), [&](Index, std::int64_t, int) { ++p.row[a + 1]; });
  }
#pragma omp parallel for schedule(static)
  for (std::size_t a = 0; a < n; ++a) {
    auto k = static_cast<std::size_t>(p.row[a]);
    Mat<3> moment = Mat<3>::Zero();
    list.for_each(static_cast<Index>(a), [&](Index b, std::int64_t, int) {
      const Vec<3> Xab = X.vec<3>(static_cast<std::size_t>(b)) - X.vec<3>(a);
      const double r = Xab.norm();
      p.neighbour[k] = b;
      p.gradient[k] = -weight * kernel.derivative(r, h) / r * Xab;
      moment += p.gradient[k] * Xab.transpose();
      ++k;
    });
    p.M[a] = moment.inverse();
  }
  return p;
}

}  // namespace taut::bench
