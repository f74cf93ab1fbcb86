#include <fmt/format.h>

#include <Eigen/LU>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/geometry/body_mesh.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/geometry/spacing.hpp>

namespace taut {
namespace {

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

// Barycentric coordinates of the centre of the ball through a simplex's corners; of their mean where the
// simplex is flat or the centre far away.
template <int D>
Vec<D + 1> centre_of(const std::vector<Vec<D>>& X, const Simplex<D>& s) {
  constexpr double flat = 1e-6, far = 20;
  Mat<D> edges;
  for (int d = 0; d < D; ++d) edges.col(d) = X[at(s[static_cast<std::size_t>(d) + 1])] - X[at(s[0])];
  const double size = edges.colwise().norm().maxCoeff();
  edges /= size;
  Vec<D + 1> lambda = Vec<D + 1>::Constant(1.0 / (D + 1));
  if (!(edges.determinant() > flat)) return lambda;
  const Mat<D> inverse = edges.inverse();
  const Vec<D> half = 0.5 * edges.colwise().squaredNorm().transpose();
  const Vec<D> c = inverse.transpose() * half;
  if (!(c.norm() < far)) return lambda;
  lambda.template tail<D>() = inverse * c;
  lambda[0] = 1 - lambda.template tail<D>().sum();
  return lambda;
}

}  // namespace

Vec<3> triangle_shares(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c) {
  const double p = (b - c).squaredNorm(), q = (c - a).squaredNorm(), r = (a - b).squaredNorm();
  const Vec<3> lambda(p * (q + r - p), q * (r + p - q), r * (p + q - r));
  const double sum = lambda.sum();  // 16 times the area squared
  if (!(sum > 1e-12 * p * q)) return Vec<3>::Constant(1.0 / 3);
  return 0.5 * (Vec<3>::Ones() - lambda / sum);
}

// The simplex falls into cones from the ball's centre over its sides, and each cone belongs to the corners of
// its side as the side does.
template <int D>
Vec<D + 1> simplex_shares(const std::vector<Vec<D>>& X, const Simplex<D>& s, unsigned outer) {
  Vec<D + 1> lambda = centre_of<D>(X, s);
  for (int k = 0; k <= D; ++k)  // across the boundary is no simplex to make up for what reaches over it
    if ((outer >> k & 1) && lambda[k] < 0) {
      const double rest = 1 - lambda[k];
      lambda[k] = 0;
      lambda /= rest;
    }
  Vec<D + 1> w = Vec<D + 1>::Zero();
  if constexpr (D == 1) {
    w.setConstant(0.5);
  } else if constexpr (D == 2) {
    w = 0.5 * (Vec<3>::Ones() - lambda);
  } else {
    for (int k = 0; k <= D; ++k) {
      std::array<int, 3> corner{};
      for (int j = 0, n = 0; j <= D; ++j)
        if (j != k) corner[static_cast<std::size_t>(n++)] = j;
      const auto x = [&](int j) {
        return X[at(s[static_cast<std::size_t>(corner[static_cast<std::size_t>(j)])])];
      };
      const Vec<3> part = triangle_shares(x(0), x(1), x(2));
      for (int j = 0; j < 3; ++j) w[corner[static_cast<std::size_t>(j)]] += lambda[k] * part[j];
    }
  }
  return w;
}

template <int D>
std::vector<double> tributary_volumes(const std::vector<Vec<D>>& X, const BodyMesh<D>& mesh) {
  constexpr double least = 0.05;  // of an equal share: below, equal shares do
  const std::size_t n = mesh.simplices.size();
  std::vector<double> volume(n), equal(X.size(), 0);
  for (std::size_t s = 0; s < n; ++s) {
    volume[s] = simplex_volume<D>(X, mesh.simplices[s]);
    for (const Index v : mesh.simplices[s]) equal[at(v)] += volume[s] / (D + 1);
  }
  std::vector<char> shared_equally(X.size(), 0);
  std::vector<double> V;
  for (bool done = false; !done;) {
    V.assign(X.size(), 0);
    for (std::size_t s = 0; s < n; ++s) {
      const Simplex<D>& corners = mesh.simplices[s];
      bool equally = false;
      for (const Index v : corners) equally = equally || shared_equally[at(v)];
      const Vec<D + 1> w = equally ? Vec<D + 1>(Vec<D + 1>::Constant(1.0 / (D + 1)))
                                   : simplex_shares<D>(X, corners, mesh.outer[s]);
      for (int k = 0; k <= D; ++k) V[at(corners[static_cast<std::size_t>(k)])] += w[k] * volume[s];
    }
    done = true;
    for (std::size_t i = 0; i < X.size(); ++i)
      if (!(V[i] > least * equal[i]) && !shared_equally[i]) {
        shared_equally[i] = 1;
        done = false;
      }
  }
  for (std::size_t i = 0; i < X.size(); ++i)
    if (!(V[i] > 0))
      throw InputError(fmt::format("particle {} at {} has no volume: does it coincide with another?", i,
                                   describe<D>(X[i])));
  return V;
}

template <int D>
void find_volumes(Cloud<D>& cloud) {
  const std::vector<double> nearest = nearest_distances<D>(cloud.X, 1);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (!(nearest[i] > 0))
      throw InputError(fmt::format("particle {} at {} coincides with another", i, describe<D>(cloud.X[i])));
  cloud.V = tributary_volumes<D>(cloud.X, body_mesh<D>(cloud.X, {}));
}

#define TAUT_INSTANTIATE(D)                                                                          \
  template std::vector<double> tributary_volumes<D>(const std::vector<Vec<D>>&, const BodyMesh<D>&); \
  template Vec<D + 1> simplex_shares<D>(const std::vector<Vec<D>>&, const Simplex<D>&, unsigned);    \
  template void find_volumes<D>(Cloud<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
