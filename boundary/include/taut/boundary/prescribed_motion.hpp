#pragma once
/// \file
/// One component of a displacement that is given in time.

#include <array>
#include <concepts>
#include <cstddef>
#include <functional>
#include <taut/base/types.hpp>
#include <utility>

namespace taut {

/// Displacement [m] and velocity [m/s] of points along one axis: of each point by its reference position X,
/// or the same of all, which is asked for once a time. Without any, points are at rest.
template <int D>
class PrescribedMotion {
 public:
  using OfPoint = std::function<double(const Vec<D>& X, double t)>;
  using OfAll = std::function<double(double t)>;

  PrescribedMotion() = default;
  /// From the displacement; where no velocity is given it is a difference of it.
  template <std::invocable<const Vec<D>&, double> F>
  PrescribedMotion(F of_point, OfPoint its_velocity = {})
      : of_point_(std::move(of_point)), velocity_of_point_(std::move(its_velocity)) {}
  template <std::invocable<double> F>
  PrescribedMotion(F of_all, OfAll its_velocity = {})
      : of_all_(std::move(of_all)), velocity_of_all_(std::move(its_velocity)) {}

  bool moves() const { return of_point_ || of_all_; }
  /// The same for positions that are counted from `origin`.
  PrescribedMotion seen_from(const Vec<D>& origin) const;

  /// Values of one time. Valid while the motion is.
  class Now {
   public:
    Now() = default;  ///< zero everywhere
    double operator()(const Vec<D>& X) const;

   private:
    friend class PrescribedMotion;
    const OfPoint* of_point_ = nullptr;  // null: all have `value_`
    double value_ = 0;
    // sum of weight times what the value at a time is over that at the first one; a single time: the value
    std::size_t count_ = 1;
    std::array<double, 5> time_{}, weight_{};
  };
  Now displacement(double t) const;
  /// Differences are of fourth order in `window` [s], over two windows before and after, from t = 0 on: no
  /// history is asked for what was before. The window should be below a time step, as histories have no scale
  /// of their own, and no small part of it, or the difference cancels.
  Now velocity(double t, double window) const;

 private:
  OfPoint of_point_, velocity_of_point_;
  OfAll of_all_, velocity_of_all_;
};

}  // namespace taut
