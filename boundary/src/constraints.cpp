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

template <int D>
void Constraints<D>::apply_to_displacements(double t, const Field& X, Field& u) const {
  for (const Set& set : sets_) {
    double* us = u.component(set.axis);
    for (const Index i : set.particles) us[i] = set.displacement ? set.displacement(X.vec<D>(i), t) : 0;
  }
  for (int d = 0; d < D; ++d)
    held_[static_cast<std::size_t>(d)].project(
        u.component(d),
        [&](const Vec<D>& point, const Displacement& follow) { return follow ? follow(point, t) : 0; });
}

template <int D>
void Constraints<D>::apply_to_velocities(double t, const Field& X, Field& v, double window) const {
  const double after = t + window, before = t - window;
  const auto velocity = [&](const Displacement& follow, const Vec<D>& at) {
    return follow ? (follow(at, after) - follow(at, before)) / (after - before) : 0;
  };
  for (const Set& set : sets_) {
    double* vs = v.component(set.axis);
    for (const Index i : set.particles) vs[i] = velocity(set.displacement, X.vec<D>(i));
  }
  for (int d = 0; d < D; ++d)
    held_[static_cast<std::size_t>(d)].project(
        v.component(d),
        [&](const Vec<D>& point, const Displacement& follow) { return velocity(follow, point); });
}

template <int D>
void Constraints<D>::apply_to_accelerations(Field& a) const {
  for (const Set& set : sets_) {
    double* as = a.component(set.axis);
    for (const Index i : set.particles) as[i] = 0;
  }
  for (int d = 0; d < D; ++d)
    held_[static_cast<std::size_t>(d)].project(a.component(d),
                                               [](const Vec<D>&, const Displacement&) { return 0.0; });
}

template <int D>
std::vector<std::uint8_t> Constraints<D>::held(Index n) const {
  std::vector<std::uint8_t> bits(static_cast<std::size_t>(n), 0);
  for (const Set& set : sets_)
    for (const Index i : set.particles)
      bits[static_cast<std::size_t>(i)] |= static_cast<std::uint8_t>(1 << set.axis);
  return bits;
}

template <int D>
bool Constraints<D>::move_later(double t, std::span<const double> times, const Field& X) const {
  for (const Set& set : sets_) {
    if (!set.displacement) continue;
    for (const Index i : set.particles) {
      const Vec<D> Xi = X.vec<D>(i);
      const double now = set.displacement(Xi, t);
      for (const double later : times)
        if (set.displacement(Xi, later) != now) return true;
    }
  }
  bool moves = false;
  for (const HeldPoints<D>& held : held_)
    held.for_each([&](const BoundPoint<D>& point, const Displacement& follow) {
      if (follow)
        for (const double later : times) moves = moves || follow(point.X, later) != follow(point.X, t);
    });
  return moves;
}

template class Constraints<1>;
template class Constraints<2>;
template class Constraints<3>;

}  // namespace taut
