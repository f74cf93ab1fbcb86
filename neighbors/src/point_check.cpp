#include <fmt/format.h>

#include <cmath>
#include <string>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/point_check.hpp>

namespace taut::detail {
namespace {

constexpr const char* axis[] = {"x", "y", "z"};

template <int D>
std::string position(const PointView<D>& points, Index a) {
  std::string text = "(";
  for (int d = 0; d < D; ++d) text += fmt::format("{}{}", d ? ", " : "", points.x[d][a]);
  return text + ")";
}

// Distances are compared squared.
bool is_radius(double r) { return r >= 1e-150 && r <= 1e150; }
constexpr const char* valid_radius = "a support radius is a finite length greater than 0 (1e-150 to 1e150)";

}  // namespace

template <int D>
void check_points(const PointView<D>& points) {
  if (points.n < 0)
    throw InputError(fmt::format("{} points: the number of points cannot be negative", points.n));
  Index bad = points.n;
#pragma omp parallel for schedule(static) reduction(min : bad) if (worth_threads(points.n))
  for (Index i = 0; i < points.n; ++i)
    for (int d = 0; d < D; ++d)
      if (!std::isfinite(points.x[d][i])) bad = std::min(bad, i);
  if (bad == points.n) return;
  for (int d = 0; d < D; ++d)
    if (!std::isfinite(points.x[d][bad]))
      throw InputError(
          fmt::format("particle {}: its {} is {}; neighbours are defined for finite coordinates only", bad,
                      axis[d], points.x[d][bad]));
}

void check_radii(const Radii& radii, Index particles) {
  if (!radii.graded()) {
    if (!is_radius(radii.one)) throw InputError(fmt::format("radius {}: {}", radii.one, valid_radius));
    return;
  }
  for (Index i = 0; i < particles; ++i)
    if (!is_radius(radii(i)))
      throw InputError(fmt::format("particle {}: its radius is {}; {}", i, radii(i), valid_radius));
}

template <int D>
void throw_coincident(const PointView<D>& points, const Radii& radii, Index a) {
  for (Index b = 0; b < points.n; ++b) {
    if (b == a) continue;
    double d2 = 0;
    for (int d = 0; d < D; ++d) {
      const double dx = points.x[d][a] - points.x[d][b];
      d2 = d == 0 ? dx * dx : d2 + dx * dx;
    }
    const double r = std::min(radii(a), radii(b));
    if (d2 <= r * r * coincident2)
      throw CoincidentPoints(fmt::format(
          "particles {} and {} coincide at {}: remove one of them, or move overlapping bodies apart",
          std::min(a, b), std::max(a, b), position(points, a)));
  }
  throw CoincidentPoints(fmt::format("particle {} coincides with another one at {}", a, position(points, a)));
}

template void check_points(const PointView<1>&);
template void check_points(const PointView<2>&);
template void check_points(const PointView<3>&);
template void throw_coincident(const PointView<1>&, const Radii&, Index);
template void throw_coincident(const PointView<2>&, const Radii&, Index);
template void throw_coincident(const PointView<3>&, const Radii&, Index);

}  // namespace taut::detail
