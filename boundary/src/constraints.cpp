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
void Constraints<D>::apply_to_positions(double t, const Field& X, Field& x) const {
  for (const Set& set : sets_) {
    double* xs = x.component(set.axis);
    const double* Xs = X.component(set.axis);
    for (const Index i : set.particles)
      xs[i] = set.displacement ? Xs[i] + set.displacement(X.vec<D>(i), t) : Xs[i];
  }
}

template <int D>
void Constraints<D>::apply_to_velocities(double t, const Field& X, Field& v, double window) const {
  const double after = t + window, before = t - window;
  for (const Set& set : sets_) {
    double* vs = v.component(set.axis);
    for (const Index i : set.particles) {
      if (!set.displacement) {
        vs[i] = 0;
        continue;
      }
      const Vec<D> Xi = X.vec<D>(i);
      vs[i] = (set.displacement(Xi, after) - set.displacement(Xi, before)) / (after - before);
    }
  }
}

template <int D>
void Constraints<D>::apply_to_accelerations(Field& a) const {
  for (const Set& set : sets_) {
    double* as = a.component(set.axis);
    for (const Index i : set.particles) as[i] = 0;
  }
}

template <int D>
std::vector<std::uint8_t> Constraints<D>::held(Index n) const {
  std::vector<std::uint8_t> bits(static_cast<std::size_t>(n), 0);
  for (const Set& set : sets_)
    for (const Index i : set.particles) bits[static_cast<std::size_t>(i)] |= static_cast<std::uint8_t>(1 << set.axis);
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
  return false;
}

template class Constraints<1>;
template class Constraints<2>;
template class Constraints<3>;

}  // namespace taut
