#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <taut/core/error.hpp>
#include <taut/core/geometry.hpp>

namespace taut {

template <int D>
std::function<bool(const Vec<D>&)> on_face(const Cloud<D>& cloud, std::string_view face) {
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
  for (std::size_t p = 0; p < cloud.size(); ++p)
    if (cloud.extra.empty() || !cloud.extra[p]) outermost = std::max(outermost, sign * cloud.X[p][axis]);
  if (!std::isfinite(outermost)) throw InputError(fmt::format("face {} of an empty cloud", face));
  return [axis, origin = cloud.origin[axis], at = sign * outermost, tolerance = cloud.dx / 4](
             const Vec<D>& X) { return std::abs((X[axis] - origin) - at) <= tolerance; };
}

template std::function<bool(const Vec<1>&)> on_face<1>(const Cloud<1>&, std::string_view);
template std::function<bool(const Vec<2>&)> on_face<2>(const Cloud<2>&, std::string_view);
template std::function<bool(const Vec<3>&)> on_face<3>(const Cloud<3>&, std::string_view);

}  // namespace taut
