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
void Constraints<D>::apply_to_displacements(double t, const Field& X, Field& u) const {
  for (const Set& set : sets_) {
    double* us = u.component(set.axis);
    for (const Index i : set.particles) us[i] = set.displacement ? set.displacement(X.vec<D>(i), t) : 0;
  }
}

template <int D>
void Constraints<D>::apply_to_velocities(double t, const Field& X, Field& v) const {
  // Wide enough for round-off, narrow against any history: displacement histories have no scale of their own.
  const double dt = 1e-6 * (t > 0 ? t : 1e-6);
  for (const Set& set : sets_) {
    double* vs = v.component(set.axis);
    for (const Index i : set.particles) {
      if (!set.displacement) {
        vs[i] = 0;
        continue;
      }
      const Vec<D> Xi = X.vec<D>(i);
      vs[i] = (set.displacement(Xi, t + dt) - set.displacement(Xi, t - dt)) / (2 * dt);
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

template class Constraints<1>;
template class Constraints<2>;
template class Constraints<3>;

}  // namespace taut
