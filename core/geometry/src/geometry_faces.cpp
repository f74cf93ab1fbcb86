#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <taut/base/error.hpp>
#include <taut/geometry/geometry.hpp>
#include <utility>

namespace taut {

namespace {

// The plane of a face of the bounding box of `count` points, of which `point(k)` gives the owning particle
// and the place.
template <int D, class Point>
std::function<bool(const Vec<D>&)> plane_of(const Cloud<D>& cloud, std::string_view face, std::size_t count,
                                            double tolerance, Point&& point) {
  constexpr std::string_view names[] = {"x_min", "x_max", "y_min", "y_max", "z_min", "z_max"};
  int found = -1;
  std::vector<std::string> valid;
  for (int f = 0; f < 2 * D; ++f) {
    if (names[f] == face) found = f;
    valid.emplace_back(names[f]);
  }
  if (found < 0)
    throw InputError(fmt::format("unknown face \"{}\"; valid in {}D: {}", face, D, join_names(valid)));

  const int axis = found / 2;
  const double sign = found % 2 ? 1 : -1;
  double outermost = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [owner, X] = point(k);
    if (cloud.extra.empty() || !cloud.extra[owner]) outermost = std::max(outermost, sign * X[axis]);
  }
  if (!std::isfinite(outermost)) throw InputError(fmt::format("face {} of an empty cloud", face));
  return [axis, origin = cloud.origin[axis], at = sign * outermost, tolerance](const Vec<D>& X) {
    return std::abs((X[axis] - origin) - at) <= tolerance;
  };
}

}  // namespace

template <int D>
std::function<bool(const Vec<D>&)> on_face(const Cloud<D>& cloud, std::string_view face) {
  return plane_of<D>(cloud, face, cloud.size(), cloud.dx / 4,
                     [&](std::size_t k) { return std::pair<std::size_t, Vec<D>>(k, cloud.X[k]); });
}

template <int D>
std::function<bool(const Vec<D>&)> on_facets(const Cloud<D>& cloud, std::string_view face) {
  return plane_of<D>(cloud, face, cloud.facets.size(), cloud.dx / 1000, [&](std::size_t k) {
    return std::pair<std::size_t, Vec<D>>(cloud.facets[k].owner, cloud.facets[k].centre);
  });
}

#define TAUT_INSTANTIATE(D)                                                                  \
  template std::function<bool(const Vec<D>&)> on_face<D>(const Cloud<D>&, std::string_view); \
  template std::function<bool(const Vec<D>&)> on_facets<D>(const Cloud<D>&, std::string_view);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
