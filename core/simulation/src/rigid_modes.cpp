#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/base/small_solve.hpp>
#include <taut/simulation/rigid_modes.hpp>

namespace taut {

namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();

template <int D>
class Body {
 public:
  static constexpr int turns = D * (D - 1) / 2;
  static constexpr int motions = D + turns;
  using Motion = Fixed<motions, 1>;  // D translations, then turns, of unit size at the rim
  using Directions = Fixed<motions>;

  // First all positions, to know the centre and the size.
  void include(const Vec<D>& X, Index id) {
    min_ = min_.cwiseMin(X);
    max_ = max_.cwiseMax(X);
    first_ = std::min(first_, id);
  }
  void finish_size() {
    centre_ = 0.5 * (min_ + max_);
    size_ = 0.5 * (max_ - min_).norm();
    const double far = std::max(min_.cwiseAbs().maxCoeff(), max_.cwiseAbs().maxCoeff());
    // Coordinates are rounded where they are given.
    negligible_ = std::max(1e-9, size_ > 0 ? 64 * rounding * far / size_ : 0);
  }
  // The displacement of X in each motion.
  Fixed<D, motions> field(const Vec<D>& X) const {
    Fixed<D, motions> f = Fixed<D, motions>::Zero();
    f.template leftCols<D>().setIdentity();
    const Vec<D> r = size_ > 0 ? Vec<D>((X - centre_) / size_) : Vec<D>::Zero();
    if constexpr (D == 2) f.col(2) = Vec<2>(-r[1], r[0]);
    if constexpr (D == 3)
      for (int k = 0; k < 3; ++k) f.col(3 + k) = Vec<3>::Unit(k).cross(r);
    return f;
  }
  // Component `axis` of the displacement of X is zero.
  void hold(const Vec<D>& X, int axis) { add_row(field(X).row(axis).transpose()); }
  // The motion is the same at all places that are a period apart along the axis.
  void hold_period(int axis) {
    for (int d = 0; d < D; ++d)
      add_row((field(Vec<D>(centre_ + size_ * Vec<D>::Unit(axis))) - field(centre_)).row(d).transpose());
  }
  // This combination of motions is zero.
  void add_row(Motion row) {
    constrained_ = true;
    for (int k = 0; k < motions;
         ++k) {  // Givens rotations: what is left is the triangle of a QR factorisation
      if (row[k] == 0) continue;
      const double length = std::hypot(rows_(k, k), row[k]), c = rows_(k, k) / length, s = row[k] / length;
      for (int j = k; j < motions; ++j) {
        const double above = rows_(k, j);
        rows_(k, j) = c * above + s * row[j];
        row[j] = c * row[j] - s * above;
      }
    }
  }
  // All of the plane X[axis] = at stays in it.
  void hold_plane(int axis, double at) {
    Vec<D> X = centre_;
    X[axis] = at;
    hold(X, axis);
    for (int d = 0; d < D; ++d)
      if (d != axis) hold(Vec<D>(X + size_ * Vec<D>::Unit(d)), axis);
  }
  double depth(int axis, double at) const {
    return std::min(std::abs(min_[axis] - at), std::abs(max_[axis] - at));
  }

  // Forces of one time.
  void push(const Vec<D>& X, const Vec<D>& force) {
    work_ += field(X).transpose() * force;
    total_ += force.norm();
    for (int d = 0; d < D; ++d) first_moments_.row(d) += force[d] * (X - centre_).transpose();
    resultant_ += force;
  }
  void let_go() {
    work_.setZero();
    total_ = 0;
    first_moments_.setZero();
    resultant_.setZero();
  }

  // Splits what is free into translations, which are along axes since constraints are, and turns.
  void find_free() {
    const Spectrum<motions> held = right_singular<motions>(rows_);
    const double small = negligible_ * held.values[0];
    Directions free = Directions::Zero();  // columns span the free motions
    for (int k = 0; k < motions; ++k)
      if (!(held.values[k] > small)) free.col(k) = held.vectors.col(k);
    for (int d = 0; d < D; ++d) {
      slides_[static_cast<std::size_t>(d)] = !(rows_.col(d).norm() > small);
      if (slides_[static_cast<std::size_t>(d)]) free.row(d).setZero();
    }
    const Spectrum<motions> rest = right_singular<motions>(free.transpose());
    turning_.clear();
    for (int k = 0; k < motions; ++k)
      if (rest.values[k] > 1e-6 && size_ > 0) turning_.push_back(rest.vectors.col(k));
  }
  bool is_free() const {
    return !turning_.empty() || std::find(slides_.begin(), slides_.end(), true) != slides_.end();
  }

  // How the forces would move the body, in words; empty where they do not.
  std::string excited() const {
    std::string text;
    for (int d = 0; d < D; ++d)
      if (slides_[static_cast<std::size_t>(d)] && std::abs(work_[d]) > negligible_ * total_)
        text += fmt::format("{}along {}", text.empty() ? "" : " and ", "xyz"[d]);
    if (turns_away()) text += text.empty() ? "round" : " and round";
    return text;
  }
  std::string free_motions() const {
    std::string slides, turns_about;
    for (int d = 0; d < D; ++d)
      if (slides_[static_cast<std::size_t>(d)])
        slides += fmt::format("{}{}", slides.empty() ? "" : ", ", "xyz"[d]);
    for (int k = 0; k < turns; ++k) {
      Motion axis = Motion::Zero();
      for (const Motion& t : turning_) axis += t[D + k] * t;
      if (axis.template tail<std::max(turns, 1)>().norm() > 0.5 || (turning_.size() == 1 && about(k)))
        turns_about += fmt::format("{}{}", turns_about.empty() ? "" : ", ", D == 2 ? 'z' : "xyz"[k]);
    }
    if (turns_about.empty() && !turning_.empty()) turns_about = "an axis";
    return fmt::format("{}{}{}{}{}", slides.empty() ? "" : "to move along ", slides,
                       !slides.empty() && !turns_about.empty() ? " and " : "",
                       turns_about.empty() ? "" : "to turn about ", turns_about);
  }
  bool constrained() const { return constrained_; }
  Index first() const { return first_; }

 private:
  // Whether the one free turn has a part about axis k.
  bool about(int k) const { return std::abs(turning_.front()[D + k]) > 1e-6; }

  // Whether the forces turn the body far. Dead loads that pull outwards end a turn of the angle
  // work / virial, as the weight of a pendulum does.
  bool turns_away() const {
    if constexpr (D == 1) {
      return false;
    } else {
      Motion push = Motion::Zero();
      for (const Motion& t : turning_) push += t * t.dot(work_);
      const double work = push.norm();
      if (!(work > negligible_ * total_)) return false;
      const Motion mode = push / work;
      Vec<3> shift = Vec<3>::Zero(), spin = Vec<3>::Zero();
      shift.template head<D>() = mode.template head<D>();
      if constexpr (D == 2)
        spin[2] = mode[2] / size_;
      else
        spin = mode.template tail<3>() / size_;
      const Vec<3> from_centre = spin.cross(shift) / spin.squaredNorm();  // the point, or axis, that stays
      Mat<3> moments = Mat<3>::Zero();                                    // of forces about that point
      moments.template topLeftCorner<D, D>() =
          first_moments_ - resultant_ * from_centre.template head<D>().transpose();
      const double virial = spin.squaredNorm() * moments.trace() - spin.dot(moments * spin);
      constexpr double near_by = 0.2;
      return !(virial > 0 && work * spin.norm() <= near_by * virial);
    }
  }

  Vec<D> min_ = Vec<D>::Constant(std::numeric_limits<double>::infinity()), max_ = -min_;
  Vec<D> centre_ = Vec<D>::Zero(), resultant_ = Vec<D>::Zero();
  Mat<D> first_moments_ = Mat<D>::Zero();
  double size_ = 0, negligible_ = 0, total_ = 0;
  Index first_ = std::numeric_limits<Index>::max();
  bool constrained_ = false;
  Directions rows_ = Directions::Zero();
  Motion work_ = Motion::Zero();
  std::array<bool, D> slides_{};
  std::vector<Motion> turning_;
};

}  // namespace

template <int D>
void require_held(const Support<D>& support) {
  const Particles<D>& p = support.particles;
  if (support.loads.empty()) return;
  std::vector<Body<D>> bodies(
      static_cast<std::size_t>(*std::max_element(support.bodies.begin(), support.bodies.end())) + 1);
  const auto body_of = [&](Index i) -> Body<D>& {
    return bodies[static_cast<std::size_t>(support.bodies[static_cast<std::size_t>(i)])];
  };
  for (Index i = 0; i < p.n; ++i)
    body_of(i).include(p.X.template vec<D>(i), p.id[static_cast<std::size_t>(i)]);
  for (Body<D>& body : bodies) body.finish_size();
  const std::vector<std::uint8_t> held = support.constraints.held(p.n);
  for (Index i = 0; i < p.n; ++i)
    for (int d = 0; d < D; ++d)
      if (held[static_cast<std::size_t>(i)] >> d & 1) body_of(i).hold(p.X.template vec<D>(i), d);
  support.constraints.for_each_point([&](const BoundPoint<D>& point, int axis) {
    body_of(point.terms.front().particle).hold(point.X, axis);
  });
  bool any = false;
  for (Body<D>& body : bodies) {
    for (const auto& period : support.periods) body.hold_period(period.axis);
    for (const auto& plane : support.planes)  // bound to its image, or on the plane
      if (2 * body.depth(plane.axis, plane.at) < support.reach) body.hold_plane(plane.axis, plane.at);
    body.find_free();
    any = any || body.is_free();
  }
  if (!any) return;
  Field a(static_cast<std::size_t>(p.n), D);
  for (const double t : support.times) {
    std::fill(a.flat().begin(), a.flat().end(), 0.0);
    support.loads.add_to(t, p.m, a);
    for (Body<D>& body : bodies) body.let_go();
    for (Index i = 0; i < p.n; ++i) {
      const Vec<D> force = p.m.component(0)[i] * p.modelled_share(i) * a.template vec<D>(i);
      if (force.allFinite()) body_of(i).push(p.X.template vec<D>(i), force);
    }
    for (const Body<D>& body : bodies) {
      const std::string excited = body.is_free() ? body.excited() : "";
      if (excited.empty()) continue;
      const Index id = body.first();
      throw InputError(fmt::format(
          "{} the body that contains particle {} at {}: it is free {}, and the loads push it {}, so that it "
          "has no equilibrium. Add a clamp, rollers or a symmetry plane, balance the loads, or use run",
          body.constrained() ? "the constraints do not hold" : "nothing holds", id,
          describe<D>(p.reference_position(p.place[static_cast<std::size_t>(id)])), body.free_motions(),
          excited));
    }
  }
}

template void require_held<1>(const Support<1>&);
template void require_held<2>(const Support<2>&);
template void require_held<3>(const Support<3>&);

}  // namespace taut
