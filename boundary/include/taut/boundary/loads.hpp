#pragma once
/// \file
/// Dead loads and body forces.

#include <functional>
#include <taut/base/fields.hpp>
#include <taut/base/types.hpp>
#include <vector>

namespace taut {

/// Forces that do not depend on the motion.
template <int D>
class Loads {
 public:
  using History = std::function<double(double t)>;

  /// `forces[i]` [N] on `particles[i]`, times history(t) (1 when empty).
  void add(std::vector<Index> particles, std::vector<Vec<D>> forces, History history = {});
  /// Acceleration [m/s^2] of all of the first `n` particles.
  void add_body_force(Index n, const Vec<D>& acceleration, History history = {});
  /// Every load grows from zero by this factor of time as well (quasi-static ramps); empty = 1.
  void set_ramp(History ramp) { ramp_ = std::move(ramp); }

  /// a += force / mass. `mass` is one value a particle.
  void add_to(double t, const Field& mass, Field& a) const;
  /// Euclidean norm over all particles of the applied forces [N].
  double norm(double t, const Field& mass) const;
  bool empty() const { return point_.empty() && body_.empty(); }
  /// Whether the loads are the same at all times, so that they have a potential.
  bool constant() const;
  /// Work [J] that the loads of time t do over the displacements u.
  double work(double t, const Field& mass, const Field& u) const;

 private:
  struct Point {
    std::vector<Index> particles;
    std::vector<Vec<D>> forces;
    History history;
  };
  struct Body {
    Index n;
    Vec<D> acceleration;
    History history;
  };
  double factor(const History& history, double t) const;
  std::vector<Point> point_;
  std::vector<Body> body_;
  History ramp_;
};

}  // namespace taut
