#include <taut/boundary/constraints.hpp>
#include <utility>

namespace taut {

template <int D>
void Constraints<D>::fix(std::vector<Index> particles, int axis) {
  sets_.push_back({std::move(particles), axis, {}});
}

template <int D>
void Constraints<D>::prescribe(std::vector<Index> particles, int axis, PrescribedMotion<D> motion) {
  sets_.push_back({std::move(particles), axis, std::move(motion)});
}

template <int D>
void Constraints<D>::hold(std::vector<BoundPoint<D>> points, int axis, PrescribedMotion<D> motion) {
  held_[static_cast<std::size_t>(axis)].add(std::move(points), std::move(motion));
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
template <class Now>
void Constraints<D>::apply(const Field& X, Field& field, Now&& now) const {
  for (const Set& set : sets_) {
    double* values = field.component(set.axis);
    const auto value = now(set.motion);
    for (const Index i : set.particles) values[i] = value(X.vec<D>(i));
  }
  for (int d = 0; d < D; ++d) held_[static_cast<std::size_t>(d)].project(field.component(d), now);
}

template <int D>
void Constraints<D>::apply_to_displacements(double t, const Field& X, Field& u) const {
  apply(X, u, [t](const PrescribedMotion<D>& motion) { return motion.displacement(t); });
}

template <int D>
void Constraints<D>::apply_to_velocities(double t, const Field& X, Field& v, double window) const {
  apply(X, v, [t, window](const PrescribedMotion<D>& motion) { return motion.velocity(t, window); });
}

template <int D>
void Constraints<D>::apply_to_accelerations(Field& a) const {
  for (const Set& set : sets_) {
    double* as = a.component(set.axis);
    for (const Index i : set.particles) as[i] = 0;
  }
  for (int d = 0; d < D; ++d)
    held_[static_cast<std::size_t>(d)].project(
        a.component(d), [](const PrescribedMotion<D>&) { return typename PrescribedMotion<D>::Now(); });
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
  const auto differs = [&](const PrescribedMotion<D>& motion, const Vec<D>& at) {
    return motion.moves() && std::any_of(times.begin(), times.end(), [&](double later) {
             return motion.displacement(later)(at) != motion.displacement(t)(at);
           });
  };
  for (const Set& set : sets_)
    for (const Index i : set.particles)
      if (differs(set.motion, X.vec<D>(i))) return true;
  bool moves = false;
  for (const HeldPoints<D>& held : held_)
    held.for_each([&](const BoundPoint<D>& point, const PrescribedMotion<D>& motion) {
      moves = moves || differs(motion, point.X);
    });
  return moves;
}

template class Constraints<1>;
template class Constraints<2>;
template class Constraints<3>;

}  // namespace taut
