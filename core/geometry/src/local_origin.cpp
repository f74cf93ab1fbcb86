#include <algorithm>
#include <cmath>
#include <limits>
#include <taut/geometry/local_origin.hpp>

namespace taut {

template <int D>
bool is_far(const Vec<D>& min, const Vec<D>& max) {
  constexpr double far = 10;  // extents: nearer ones lose less than a digit
  const double extent = (max - min).maxCoeff();
  return std::isfinite(extent) && extent > 0 &&
         std::max(min.cwiseAbs().maxCoeff(), max.cwiseAbs().maxCoeff()) > far * extent;
}

double coordinate_rounding(double a) { return 4 * std::numeric_limits<double>::epsilon() * std::abs(a); }

double coordinate_difference(double a, double b) {
  const double difference = a - b;
  const double rounding = (coordinate_rounding(a) + coordinate_rounding(b)) / 4;
  constexpr double digits_left = 1e15;
  if (!(rounding * digits_left > std::abs(difference)) || !std::isfinite(difference)) return difference;
  double scale = 1;
  for (int decimals = 0; decimals <= 22; ++decimals, scale *= 10) {  // powers of ten that doubles have
    const double rounded = std::round(difference * scale) / scale;
    if (std::abs(rounded - difference) <= rounding) return rounded;
  }
  return difference;
}

template <int D>
void make_local(Cloud<D>& cloud) {
  if (cloud.size() == 0) return;
  Vec<D> min = cloud.X.front(), max = min;
  for (const Vec<D>& X : cloud.X) {
    min = min.cwiseMin(X);
    max = max.cwiseMax(X);
  }
  if (!is_far<D>(min, max)) return;
  for (Vec<D>& X : cloud.X) X = coordinate_difference<D>(X, min);
  for (Facet<D>& facet : cloud.facets) facet.centre = coordinate_difference<D>(facet.centre, min);
  cloud.origin += min;
}

#define TAUT_INSTANTIATE(D)                              \
  template bool is_far<D>(const Vec<D>&, const Vec<D>&); \
  template void make_local<D>(Cloud<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
