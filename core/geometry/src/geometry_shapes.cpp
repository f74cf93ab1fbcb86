#include <fmt/format.h>

#include <cmath>
#include <taut/base/error.hpp>
#include <taut/geometry/geometry.hpp>
#include <utility>

namespace taut {
namespace {

constexpr const char* axis_names[] = {"x", "y", "z"};

template <int D>
void require_finite(const Vec<D>& point, const char* what) {
  for (int d = 0; d < D; ++d)
    if (!std::isfinite(point[d]))
      throw InputError(fmt::format("{}: {} = {} is not finite", what, axis_names[d], point[d]));
}

void require_radius(double radius, const char* what) {
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError(fmt::format("{} {} is not positive and finite", what, radius));
}

}  // namespace

template <int D>
Shape<D>::Shape(std::function<bool(const Vec<D>&)> contains, const Vec<D>& min, const Vec<D>& max)
    : contains_(std::move(contains)), min_(min), max_(max) {
  if (!contains_) throw InputError("shape: the function that says what is inside is empty");
  require_finite<D>(min, "shape: corner min");
  require_finite<D>(max, "shape: corner max");
  for (int d = 0; d < D; ++d)
    if (!(min[d] < max[d]))
      throw InputError(
          fmt::format("shape: {0}_min = {1} is not less than {0}_max = {2}", axis_names[d], min[d], max[d]));
}

template <int D>
Shape<D> Shape<D>::operator|(const Shape& other) const {
  return Shape([a = contains_, b = other.contains_](const Vec<D>& X) { return a(X) || b(X); },
               min_.cwiseMin(other.min_), max_.cwiseMax(other.max_));
}

template <int D>
Shape<D> Shape<D>::operator-(const Shape& other) const {
  return Shape([a = contains_, b = other.contains_](const Vec<D>& X) { return a(X) && !b(X); }, min_, max_);
}

template <int D>
Shape<D> box(const Vec<D>& min, const Vec<D>& max) {
  return Shape<D>(
      [min, max](const Vec<D>& X) {
        return (X.array() >= min.array()).all() && (X.array() <= max.array()).all();
      },
      min, max);
}

template <int D>
Shape<D> sphere(const Vec<D>& centre, double radius) {
  require_finite<D>(centre, "sphere: centre");
  require_radius(radius, "sphere: radius");
  const Vec<D> reach = Vec<D>::Constant(radius);
  return Shape<D>(
      [centre, r2 = radius * radius](const Vec<D>& X) { return (X - centre).squaredNorm() <= r2; },
      centre - reach, centre + reach);
}

template <int D>
Shape<D> ring(const Vec<D>& centre, double inner_radius, double outer_radius) {
  require_finite<D>(centre, "ring: centre");
  require_radius(inner_radius, "ring: inner radius");
  require_radius(outer_radius, "ring: outer radius");
  if (!(inner_radius < outer_radius))
    throw InputError(
        fmt::format("ring: inner radius {} is not less than outer radius {}", inner_radius, outer_radius));
  const Vec<D> reach = Vec<D>::Constant(outer_radius);
  return Shape<D>(
      [centre, inner2 = inner_radius * inner_radius, outer2 = outer_radius * outer_radius](const Vec<D>& X) {
        const double r2 = (X - centre).squaredNorm();
        return inner2 <= r2 && r2 <= outer2;
      },
      centre - reach, centre + reach);
}

Shape<3> cylinder(const Vec<3>& from, const Vec<3>& to, double radius) {
  require_finite<3>(from, "cylinder: first end");
  require_finite<3>(to, "cylinder: second end");
  require_radius(radius, "cylinder: radius");
  const double length = (to - from).norm();
  if (!(length > 0)) throw InputError("cylinder: its two ends are the same point");
  const Vec<3> axis = (to - from) / length;
  const Vec<3> reach = radius * (1 - axis.array().square()).max(0).sqrt();
  return Shape<3>(
      [from, axis, length, r2 = radius * radius](const Vec<3>& X) {
        const Vec<3> d = X - from;
        const double s = d.dot(axis);
        return 0 <= s && s <= length && (d - s * axis).squaredNorm() <= r2;
      },
      from.cwiseMin(to) - reach, from.cwiseMax(to) + reach);
}

template <int D>
Shape<D> implicit(std::function<double(const Vec<D>&)> f, const Vec<D>& min, const Vec<D>& max) {
  if (!f) throw InputError("implicit: the function is empty");
  return Shape<D>([f = std::move(f),
                   bounds = box<D>(min, max)](const Vec<D>& X) { return bounds.contains(X) && f(X) < 0; },
                  min, max);
}

#define TAUT_INSTANTIATE(D)                                 \
  template class Shape<D>;                                  \
  template Shape<D> box<D>(const Vec<D>&, const Vec<D>&);   \
  template Shape<D> sphere<D>(const Vec<D>&, double);       \
  template Shape<D> ring<D>(const Vec<D>&, double, double); \
  template Shape<D> implicit<D>(std::function<double(const Vec<D>&)>, const Vec<D>&, const Vec<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
