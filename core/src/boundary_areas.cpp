#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <taut/core/error.hpp>
#include <taut/core/geometry.hpp>
#include <taut/core/kernel.hpp>
#include <taut/neighbors/search.hpp>

namespace taut {

namespace {

// How far around a particle its place in the body is judged [dx].
constexpr double reach_dx = 2.1;

template <int D>
struct Surroundings {
  PairList pairs;
  const std::vector<Vec<D>>& X;

  explicit Surroundings(const Cloud<D>& cloud) : X(cloud.X) {
    Field x(cloud.size(), D);
    for (std::size_t i = 0; i < cloud.size(); ++i) x.template set_vec<D>(i, cloud.X[i]);
    pairs = find_pairs<D>(points_of<D>(x, static_cast<Index>(cloud.size())), reach_dx * cloud.dx);
  }
  // f(b, X_b - X_a) for each neighbour b of a.
  template <class F>
  void each(std::size_t a, F&& f) const {
    pairs.for_each(static_cast<Index>(a), [&](Index b, std::int64_t, int) {
      f(static_cast<std::size_t>(b), Vec<D>(X[static_cast<std::size_t>(b)] - X[a]));
    });
  }
};

// Outward unit normals of the particles on the surface, zero for those inside: on the surface the neighbours
// lie to one side, and a cone about the other one is free of them (Marrone et al., J. Comput. Phys. 229,
// 2010).
template <int D>
std::vector<Vec<D>> surface_normals(const Cloud<D>& cloud, const Surroundings<D>& around) {
  constexpr double cone = 0.766;  // cosine of its half angle, 40 degrees: less than a re-entrant corner's 45
  constexpr double one_sided = 0.15;  // of a jittered interior it is a few hundredths, on a plane face 0.4
  const Kernel kernel("wendland_c2", D);
  const double h = reach_dx * cloud.dx / kernel.radius_factor();
  std::vector<Vec<D>> normal(cloud.size(), Vec<D>::Zero());
#pragma omp parallel for schedule(static)
  for (std::size_t a = 0; a < cloud.size(); ++a) {
    Vec<D> sum = Vec<D>::Zero();
    double size = 0;
    around.each(a, [&](std::size_t b, const Vec<D>& X) {
      const double w = cloud.V[b] * kernel.value(X.norm(), h);
      sum -= w * X;
      size += w * X.norm();
    });
    if (!(sum.norm() > one_sided * size)) continue;
    const Vec<D> n = sum.normalized();
    bool free = true;
    around.each(a, [&](std::size_t, const Vec<D>& X) { free = free && X.dot(n) <= cone * X.norm(); });
    if (free) normal[a] = n;
  }
  return normal;
}

// Each particle's share of the surface: one over the density of surface particles on its own side of the
// body.
template <int D>
double surface_share(const Cloud<D>& cloud, const Surroundings<D>& around, const std::vector<Vec<D>>& normal,
                     std::size_t a) {
  if constexpr (D == 1) {
    return 1;
  } else {
    const Kernel kernel("wendland_c2", D - 1);
    const double h = reach_dx * cloud.dx / kernel.radius_factor();
    double density = kernel.value(0, h);
    around.each(a, [&](std::size_t b, const Vec<D>& X) {
      if (normal[b].dot(normal[a]) > 0) density += kernel.value(X.norm(), h);
    });
    return 1 / density;
  }
}

}  // namespace

template <int D>
double close_areas(Cloud<D>& cloud) {
  using Basis = Eigen::Matrix<double, D + 1, 1>;
  Vec<D> centre = Vec<D>::Zero();
  for (const Vec<D>& X : cloud.X) centre += X / static_cast<double>(cloud.size());
  double volume = 0, total = 0, change = 0;
  for (const double V : cloud.V) volume += V;
  Eigen::Matrix<double, D + 1, D + 1> normal = Eigen::Matrix<double, D + 1, D + 1>::Zero();
  Eigen::Matrix<double, D + 1, D> defect = Eigen::Matrix<double, D + 1, D>::Zero();  // [sum B; sum X (x) B]
  const auto basis = [&](std::size_t a) {
    Basis f;
    f << 1, (cloud.X[a] - centre) / cloud.dx;
    return f;
  };
  for (int d = 0; d < D; ++d) defect(d + 1, d) = volume / cloud.dx;
  for (std::size_t a = 0; a < cloud.size(); ++a) {
    if (cloud.B[a].isZero()) continue;
    const Basis f = basis(a);
    normal += cloud.B[a].norm() * f * f.transpose();
    defect -= f * cloud.B[a].transpose();
    total += cloud.B[a].norm();
  }
  const Eigen::FullPivLU<Eigen::Matrix<double, D + 1, D + 1>> lu(normal);
  if (!lu.isInvertible())
    throw InputError("the boundary areas do not enclose the body: its surface particles lie on one plane");
  const Eigen::Matrix<double, D + 1, D> multiplier = lu.solve(defect);
  for (std::size_t a = 0; a < cloud.size(); ++a) {
    if (cloud.B[a].isZero()) continue;
    const Vec<D> delta = cloud.B[a].norm() * (multiplier.transpose() * basis(a));
    change += delta.norm();
    cloud.B[a] += delta;
  }
  return change / total;
}

template <int D>
double estimate_areas(Cloud<D>& cloud) {
  const Surroundings<D> around(cloud);
  const std::vector<Vec<D>> normal = surface_normals(cloud, around);
  if (std::all_of(normal.begin(), normal.end(), [](const Vec<D>& n) { return n.isZero(); }))
    throw InputError("estimate_areas: no particle lies on a surface; is the spacing dx right?");
  cloud.B.assign(cloud.size(), Vec<D>::Zero());
  // Normals of the same face, averaged: what jitter inside does to one alone is no property of the surface.
  constexpr double same_face = 0.9;
#pragma omp parallel for schedule(static)
  for (std::size_t a = 0; a < cloud.size(); ++a) {
    if (normal[a].isZero()) continue;
    Vec<D> mean = normal[a];
    around.each(a, [&](std::size_t b, const Vec<D>&) {
      if (normal[b].dot(normal[a]) > same_face) mean += normal[b];
    });
    cloud.B[a] = surface_share(cloud, around, normal, a) * mean.normalized();
  }
  return close_areas(cloud);
}

#define TAUT_INSTANTIATE(D)                  \
  template double close_areas<D>(Cloud<D>&); \
  template double estimate_areas<D>(Cloud<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
