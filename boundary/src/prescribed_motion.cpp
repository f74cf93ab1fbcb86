#include <algorithm>
#include <cmath>
#include <taut/boundary/prescribed_motion.hpp>

namespace taut {

namespace {

// d/ds of Lagrange's polynomial that is 1 at node k of 0 … 4 and 0 at the others.
double slope(int k, double s) {
  double sum = 0;
  for (int m = 0; m < 5; ++m) {
    if (m == k) continue;
    double product = 1.0 / (k - m);
    for (int j = 0; j < 5; ++j)
      if (j != k && j != m) product *= (s - j) / (k - j);
    sum += product;
  }
  return sum;
}

}  // namespace

template <int D>
double PrescribedMotion<D>::Now::operator()(const Vec<D>& X) const {
  if (!of_point_) return value_;
  const double first = (*of_point_)(X, time_[0]);
  if (count_ == 1) return first;
  // The weights cancel: histories that stand still have no velocity, not even round-off.
  double sum = 0;
  for (std::size_t k = 1; k < count_; ++k) sum += weight_[k] * ((*of_point_)(X, time_[k]) - first);
  return sum;
}

template <int D>
auto PrescribedMotion<D>::displacement(double t) const -> Now {
  Now now;
  if (of_all_) now.value_ = of_all_(t);
  if (!of_point_) return now;
  now.of_point_ = &of_point_;
  now.time_[0] = t;
  return now;
}

template <int D>
auto PrescribedMotion<D>::velocity(double t, double window) const -> Now {
  Now now;
  if (velocity_of_all_) {
    now.value_ = velocity_of_all_(t);
    return now;
  }
  if (velocity_of_point_) {
    now.of_point_ = &velocity_of_point_;
    now.time_[0] = t;
    return now;
  }
  if (!moves() || !(window > 0) || !std::isfinite(window)) return now;
  // A power of two is not rounded when it is added to the time, so that differences are over what they say.
  const double w = std::ldexp(1.0, std::ilogb(window));
  const double begin = std::max(t - 2 * w, 0.0), s = begin > 0 ? 2 : t / w;
  now.count_ = 1;
  now.time_[0] = begin;
  for (int k = 1; k < 5; ++k) {
    if (s == 2 && k == 2) continue;  // has no weight
    now.time_[now.count_] = begin + k * w;
    now.weight_[now.count_++] = slope(k, s) / w;
  }
  if (of_point_) {
    now.of_point_ = &of_point_;
    return now;
  }
  const double first = of_all_(begin);
  for (std::size_t k = 1; k < now.count_; ++k) now.value_ += now.weight_[k] * (of_all_(now.time_[k]) - first);
  return now;
}

template <int D>
PrescribedMotion<D> PrescribedMotion<D>::seen_from(const Vec<D>& origin) const {
  PrescribedMotion moved = *this;
  for (OfPoint* f : {&moved.of_point_, &moved.velocity_of_point_})
    if (*f) *f = [f = std::move(*f), origin](const Vec<D>& X, double t) { return f(origin + X, t); };
  return moved;
}

template class PrescribedMotion<1>;
template class PrescribedMotion<2>;
template class PrescribedMotion<3>;

}  // namespace taut
