#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <taut/simulation/input_checks.hpp>
#include <vector>

namespace taut {

namespace {

void same_number(std::size_t particles, std::size_t values, const char* what) {
  if (values != particles)
    throw InputError(fmt::format("the cloud has {} positions but {} {}", particles, values, what));
}

template <int D>
void check_cells(const Cloud<D>& cloud) {
  for (std::size_t q = 0; q < cloud.cells.size(); ++q) {
    auto corners = cloud.cells[q];
    for (const Index corner : corners)
      if (corner < 0 || static_cast<std::size_t>(corner) >= cloud.size())
        throw InputError(
            fmt::format("corner {} of cell {} is none of the {} particles", corner, q, cloud.size()));
    std::sort(corners.begin(), corners.end());
    const auto twice = std::adjacent_find(corners.begin(), corners.end());
    if (twice != corners.end())
      throw InputError(fmt::format("cell {} has particle {} for two of its corners", q, *twice));
  }
  if (cloud.cell_share.empty()) return;
  if (cloud.cell_share.size() != cloud.cells.size())
    throw InputError(fmt::format("the cloud has {} cells but {} shares of them", cloud.cells.size(),
                                 cloud.cell_share.size()));
  double sum = 0;
  for (std::size_t q = 0; q < cloud.cell_share.size(); ++q) {
    const double share = cloud.cell_share[q];
    if (!(share >= 0 && share <= 1))
      throw InputError(fmt::format("the share of cell {} that is body is {:g}; it must be 0 … 1", q, share));
    sum += share;
  }
  if (!cloud.cells.empty() && sum == 0) throw InputError("no cell of the cloud has a share that is body");
}

// Below this many digits a body's shape is rounding.
template <int D>
void check_distance(const Cloud<D>& cloud) {
  constexpr double least = 1000;
  double farthest = 0;
  for (const Vec<D>& X : cloud.X)
    farthest = std::max(farthest, (cloud.origin + X).template lpNorm<Eigen::Infinity>());
  const double resolution = std::nextafter(farthest, std::numeric_limits<double>::infinity()) - farthest;
  if (cloud.dx < least * resolution)
    throw InputError(
        fmt::format("the body lies {:g} m from the origin, where coordinates have a resolution of {:.3g} m: "
                    "its spacing of "
                    "{:g} m is {:.3g} of these and must be {:g} at least. Move it towards the origin",
                    farthest, resolution, cloud.dx, cloud.dx / resolution, least));
}

}  // namespace

template <int D>
void check_cloud(const Cloud<D>& cloud) {
  const std::size_t n = cloud.size();
  if (n == 0) throw InputError("the body has no particles");
  if (!(cloud.dx > 0) || !std::isfinite(cloud.dx))
    throw InputError(fmt::format("the cloud's spacing dx = {:g} must be positive", cloud.dx));
  same_number(n, cloud.V.size(), "volumes");
  if (!cloud.spacing.empty()) same_number(n, cloud.spacing.size(), "spacings");
  if (!cloud.B.empty()) same_number(n, cloud.B.size(), "boundary area vectors");
  if (!cloud.extra.empty()) same_number(n, cloud.extra.size(), "marks of added layers");
  if (!cloud.origin.allFinite()) throw InputError("the origin of the cloud is not finite");
  for (std::size_t i = 0; i < n; ++i) {
    for (int d = 0; d < D; ++d)
      if (!std::isfinite(cloud.X[i][d]))
        throw InputError(
            fmt::format("particle {}: its {} is {}; positions are finite", i, "xyz"[d], cloud.X[i][d]));
    if (!(cloud.V[i] > 0) || !std::isfinite(cloud.V[i]))
      throw InputError(fmt::format("particle {} has volume {:g}; it must be positive", i, cloud.V[i]));
    if (!cloud.spacing.empty() && (!(cloud.spacing[i] > 0) || !std::isfinite(cloud.spacing[i])))
      throw InputError(fmt::format("the cloud's spacings must be positive; that of particle {} is {:g}", i,
                                   cloud.spacing[i]));
    if (!cloud.B.empty() && !cloud.B[i].allFinite())
      throw InputError(fmt::format("the boundary area vector of particle {} is not finite", i));
  }
  for (std::size_t f = 0; f < cloud.facets.size(); ++f) {
    const Facet<D>& facet = cloud.facets[f];
    if (facet.owner < 0 || static_cast<std::size_t>(facet.owner) >= n)
      throw InputError(fmt::format("the owner {} of a facet is none of the {} particles", facet.owner, n));
    if (!facet.centre.allFinite() || !facet.area.allFinite())
      throw InputError(fmt::format("the {} of facet {} is not finite",
                                   facet.centre.allFinite() ? "area vector" : "centre", f));
  }
  check_cells(cloud);
  if (!(cloud.body_volume >= 0) || !std::isfinite(cloud.body_volume))
    throw InputError(fmt::format("the cloud's body_volume = {:g} must not be negative", cloud.body_volume));
  check_distance(cloud);
}

void check_options(double duration, const RunOptions& options) {
  if (!(duration >= 0) || !std::isfinite(duration))
    throw InputError(fmt::format("run: the duration {:g} s must not be negative", duration));
  if (!(options.cfl > 0) || !std::isfinite(options.cfl))
    throw InputError(fmt::format("run: cfl = {:g} must be positive and finite", options.cfl));
  if (!(options.max_step >= 0) || !std::isfinite(options.max_step))
    throw InputError(fmt::format("run: max_step = {:g} s must be positive, or 0 for none", options.max_step));
  if (options.cfl > 1 && options.max_step == 0)
    throw InputError(fmt::format(
        "run: cfl = {:g} makes steps that are longer than the stable one. It must be 1 at most, unless "
        "max_step gives the step",
        options.cfl));
}

void check_options(const RelaxOptions& options) {
  const auto time = [](const char* what, double value) {
    if (!(value >= 0) || !std::isfinite(value))
      throw InputError(fmt::format("relax: {} = {:g} s must not be negative", what, value));
  };
  if (!(options.tolerance > 0) || !std::isfinite(options.tolerance))
    throw InputError(fmt::format("relax: tolerance = {:g} must be positive and finite", options.tolerance));
  if (!(options.cfl > 0 && options.cfl <= 1))
    throw InputError(fmt::format("relax: cfl = {:g} must be positive, and 1 at most", options.cfl));
  time("ramp_time", options.ramp_time);
  time("free_time", options.free_time);
  if (options.max_steps < 0)
    throw InputError(fmt::format("relax: max_steps = {} must not be negative", options.max_steps));
}

template void check_cloud<1>(const Cloud<1>&);
template void check_cloud<2>(const Cloud<2>&);
template void check_cloud<3>(const Cloud<3>&);

}  // namespace taut
