#include <cmath>
#include <taut/boundary/loads.hpp>
#include <utility>

namespace taut {

template <int D>
void Loads<D>::add(std::vector<Index> particles, std::vector<Vec<D>> forces, History history) {
  point_.push_back({std::move(particles), std::move(forces), std::move(history)});
}

template <int D>
void Loads<D>::add_body_force(Index n, const Vec<D>& acceleration, History history) {
  body_.push_back({n, acceleration, std::move(history)});
}

template <int D>
double Loads<D>::factor(const History& history, double t) const {
  return (history ? history(t) : 1.0) * (ramp_ ? ramp_(t) : 1.0);
}

template <int D>
void Loads<D>::add_to(double t, const Field& mass, Field& a) const {
  const double* m = mass.component(0);
  for (const Body& load : body_) {
    const double f = factor(load.history, t);
    for (int d = 0; d < D; ++d) {
      double* ad = a.component(d);
      const double g = f * load.acceleration[d];
#pragma omp parallel for schedule(static) if (load.n > 65536)
      for (Index i = 0; i < load.n; ++i) ad[i] += g;
    }
  }
  for (const Point& load : point_) {
    const double f = factor(load.history, t);
    for (int d = 0; d < D; ++d) {
      double* ad = a.component(d);
      for (std::size_t k = 0; k < load.particles.size(); ++k)
        ad[load.particles[k]] += f * load.forces[k][d] / m[load.particles[k]];
    }
  }
}

template <int D>
bool Loads<D>::constant() const {
  if (ramp_) return false;
  for (const Point& load : point_)
    if (load.history) return false;
  for (const Body& load : body_)
    if (load.history) return false;
  return true;
}

template <int D>
double Loads<D>::work(double t, const Field& mass, const Field& u) const {
  double sum = 0;
  for (const Point& load : point_) {
    double of_load = 0;
    for (std::size_t k = 0; k < load.particles.size(); ++k) {
      const auto i = static_cast<std::size_t>(load.particles[k]);
      of_load += load.forces[k].dot(u.template vec<D>(i));
    }
    sum += factor(load.history, t) * of_load;
  }
  for (const Body& load : body_) {
    double of_load = 0;
    for (std::size_t i = 0; i < static_cast<std::size_t>(load.n); ++i)
      of_load += mass.component(0)[i] * load.acceleration.dot(u.template vec<D>(i));
    sum += factor(load.history, t) * of_load;
  }
  return sum;
}

template <int D>
double Loads<D>::norm(double t, const Field& mass) const {
  double sum = 0;
  for (const Point& load : point_) {
    const double f = factor(load.history, t);
    for (const Vec<D>& force : load.forces) sum += f * f * force.squaredNorm();
  }
  for (const Body& load : body_) {
    const double f = factor(load.history, t);
    for (Index i = 0; i < load.n; ++i) {
      const double m = mass.component(0)[i];
      sum += f * f * m * m * load.acceleration.squaredNorm();
    }
  }
  return std::sqrt(sum);
}

template class Loads<1>;
template class Loads<2>;
template class Loads<3>;

}  // namespace taut
