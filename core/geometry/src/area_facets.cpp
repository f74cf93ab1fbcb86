#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/geometry/spacing.hpp>

namespace taut {
namespace {

// Of D directions how much of each makes up B; nothing unless all are forwards.
template <int D>
bool compose(const std::array<Vec<D>, D>& direction, const Vec<D>& B, Vec<D>& amount) {
  constexpr double independent = 0.05, forwards = -1e-9, nothing = 1e-9;
  Mat<D> N;
  for (int d = 0; d < D; ++d) N.col(d) = direction[static_cast<std::size_t>(d)];
  if (!(std::abs(N.determinant()) > independent)) return false;
  amount = N.inverse() * B;
  if (!(amount.minCoeff() > forwards * B.norm())) return false;
  amount = (amount.array() < nothing * B.norm()).select(0, amount);
  return true;
}

// The faces that meet in a particle on an edge or in a corner, by the normals that its neighbours have: of
// all ways to make up its area by theirs the one with most area. One face, its own, unless that is a fifth
// more: two faces at an angle of 67 degrees or more.
template <int D>
std::vector<Vec<D>> faces_of(const Vec<D>& B, const std::vector<Vec<D>>& normals) {
  constexpr double edge = 1.2, facing = 0.2, same = 0.99;
  std::vector<Vec<D>> best{B};
  if constexpr (D > 1) {
    std::vector<Vec<D>> n;
    for (const Vec<D>& m : normals)
      if (m.dot(B) > facing * B.norm() &&
          std::none_of(n.begin(), n.end(), [&](const Vec<D>& o) { return o.dot(m) > same; }))
        n.push_back(m);
    double most = edge * B.norm();
    const auto consider = [&](const std::array<Vec<D>, D>& direction, int count) {
      Vec<D> amount;
      if (!compose<D>(direction, B, amount) || !(amount.sum() > most)) return;
      for (int d = count; d < D; ++d)
        if (amount[d] > 0) return;
      most = amount.sum();
      best.clear();
      for (int d = 0; d < count; ++d)
        if (amount[d] > 0) best.push_back(amount[d] * direction[static_cast<std::size_t>(d)]);
    };
    for (std::size_t i = 0; i < n.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if constexpr (D == 2) {
          consider({n[i], n[j]}, 2);
        } else {
          Vec<3> across(n[i][1] * n[j][2] - n[i][2] * n[j][1], n[i][2] * n[j][0] - n[i][0] * n[j][2],
                        n[i][0] * n[j][1] - n[i][1] * n[j][0]);
          if (across.dot(B) < 0) across *= -1;
          if (across.norm() > 0) consider({n[i], n[j], across.normalized()}, 2);
          for (std::size_t k = 0; k < j; ++k) consider({n[i], n[j], n[k]}, 3);
        }
      }
  }
  return best;
}

}  // namespace

template <int D>
void place_areas(Cloud<D>& cloud) {
  constexpr double longest = 3, on_the_particles = 1e-9;
  std::vector<std::size_t> id;
  std::vector<Vec<D>> X, normal;
  Vec<D> middle = Vec<D>::Zero();
  for (const Vec<D>& x : cloud.X) middle += x / static_cast<double>(cloud.size());
  for (std::size_t a = 0; a < cloud.size(); ++a)
    if (!cloud.B[a].isZero(0)) {
      id.push_back(a);
      X.push_back(cloud.X[a]);
      normal.push_back(cloud.B[a].normalized());
    }
  constexpr int around = D == 3 ? 13 : 5;
  const std::vector<Index> nearest = nearest_points<D>(X, around);

  // The surface is a cell's half away, V over twice the area, or not at all, or between: what encloses sum V.
  cloud.facets.clear();
  std::vector<Vec<D>> way;
  double missing = 0, reach = 0;
  for (const double V : cloud.V) missing += D * V;
  for (std::size_t k = 0; k < id.size(); ++k) {
    std::vector<Vec<D>> normals;
    for (std::size_t j = 1; j < around; ++j) {
      const Index other = nearest[k * around + j];
      if (other != no_particle) normals.push_back(normal[static_cast<std::size_t>(other)]);
    }
    const double V = cloud.V[id[k]];
    for (const Vec<D>& A : faces_of<D>(cloud.B[id[k]], normals)) {
      const double half = 0.5 * std::min(V / A.norm(), longest * std::pow(V, 1.0 / D));
      cloud.facets.push_back({X[k], A, static_cast<Index>(id[k])});
      way.push_back(half * A.normalized());
      missing -= (X[k] - middle).dot(A);
      reach += way.back().dot(A);
    }
  }
  if (!(reach > 0)) throw InputError("the boundary areas are all zero");
  const double share = missing / reach;
  if (std::abs(share) > on_the_particles)
    for (std::size_t f = 0; f < way.size(); ++f) cloud.facets[f].centre += share * way[f];
}

template void place_areas<1>(Cloud<1>&);
template void place_areas<2>(Cloud<2>&);
template void place_areas<3>(Cloud<3>&);

}  // namespace taut
