#include <taut/boundary/constraints.hpp>
#include <utility>

namespace taut {

template <int D>
void Constraints<D>::fix(std::vector<Index> particles, int axis) {
  sets_.push_back({std::move(particles), axis, {}});
}

template <int D>
void Constraints<D>::prescribe(std::vector<Index> particles, int axis, Displacement displacement) {
  sets_.push_back({std::move(particles), axis, std::move(displacement)});
}

template <int D>
void Constraints<D>::hold(std::vector<BoundPoint<D>> points, int axis, Displacement displacement) {
  held_[static_cast<std::size_t>(axis)].add(std::move(points), std::move(displacement));
}

template <int D>
void Constraints<D>::finish(const Field& mass) {
  for (std::size_t axis = 0; axis < D; ++axis) {
    if (held_[axis].empty()) continue;
    std::vector<char> fixed(mass.particles(), 0);
    for (const Set& set : sets_)
      if (set.axis == static_cast<int>(axis))
        for (const Index i : set.particles) fixed[static_cast<std::size_t>(i)] = 1;
    held_[axis].factor(mass, fixed);
  }
}

namespace {

// Wide enough for round-off, narrow against any history: displacement histories have no scale of their own.
template <int D>
double velocity_of(const std::function<double(const Vec<D>&, double)>& displacement, const Vec<D>& X, double t) {
  if (!displacement) return 0;
  const double dt = 1e-6 * (t > 0 ? t : 1e-6);
  return (displacement(X, t + dt) - displacement(X, t - dt)) / (2 * dt);
}

}  // namespace

template <int D>
void Constraints<D>::apply_to_displacements(double t, const Field& X, Field& u) const {
  for (const Set& set : sets_) {
    double* us = u.component(set.axis);
    for (const Index i : set.particles) us[i] = set.displacement ? set.displacement(X.vec<D>(i), t) : 0;
  }
  for (int d = 0; d < D; ++d)
    held_[static_cast<std::size_t>(d)].project(
        u.component(d), [&](const Vec<D>& point, const Displacement& follow) { return follow ? follow(point, t) : 0; });
}

template <int D>
void Constraints<D>::apply_to_velocities(double t, const Field& X, Field& v) const {
  for (const Set& set : sets_) {
    double* vs = v.component(set.axis);
    for (const Index i : set.particles) vs[i] = velocity_of<D>(set.displacement, X.vec<D>(i), t);
  }
  for (int d = 0; d < D; ++d)
    held_[static_cast<std::size_t>(d)].project(
        v.component(d), [&](const Vec<D>& point, const Displacement& u) { return velocity_of<D>(u, point, t); });
}

template <int D>
void Constraints<D>::apply_to_accelerations(Field& a) const {
  for (const Set& set : sets_) {
    double* as = a.component(set.axis);
    for (const Index i : set.particles) as[i] = 0;
  }
  for (int d = 0; d < D; ++d)
    held_[static_cast<std::size_t>(d)].project(a.component(d), [](const Vec<D>&, const Displacement&) { return 0.0; });
}

template class Constraints<1>;
template class Constraints<2>;
template class Constraints<3>;

}  // namespace taut
