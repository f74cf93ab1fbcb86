#include <doctest/doctest.h>

#include <cmath>
#include <taut/base/error.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/integrators/relax.hpp>
#include <taut/integrators/vector_ops.hpp>
#include <vector>

using namespace taut;

namespace {

/// Uncoupled oscillators x'' = -w^2 x + g, and a variable y that follows x by its rate.
class Oscillators final : public Dynamics {
 public:
  Oscillators(std::vector<double> frequencies, double g)
      : w_(std::move(frequencies)),
        g_(g),
        x_(w_.size(), 1.0),
        v_(w_.size()),
        a_(w_.size()),
        m_(w_.size(), 2.0),
        y_(x_),
        y_rate_(w_.size()) {}
  std::span<double> positions() override { return x_; }
  std::span<double> velocities() override { return v_; }
  std::span<const double> accelerations() override { return a_; }
  std::span<const double> masses() override { return m_; }
  std::vector<Evolved> evolved() override { return {{y_, y_rate_}}; }
  void update_rates(double) override { y_rate_ = v_; }
  void update_accelerations(double) override {
    for (std::size_t i = 0; i < x_.size(); ++i) a_[i] = g_ - w_[i] * w_[i] * x_[i];
  }
  double stable_step() const override { return 2 / w_.back(); }
  const std::vector<double>& followed() const { return y_; }

 private:
  std::vector<double> w_;
  double g_;
  std::vector<double> x_, v_, a_, m_, y_, y_rate_;
};

double error_after_one_period(const char* name, int steps) {
  Oscillators system({1.0}, 0);
  system.update_accelerations(0);
  const auto integrator = make_integrator(name);
  const double dt = 2 * std::acos(-1.0) / steps;
  for (int i = 0; i < steps; ++i) integrator->step(system, i * dt, dt);
  return std::abs(system.positions()[0] - 1) + std::abs(system.positions()[0] - system.followed()[0]);
}

}  // namespace

TEST_CASE("integrators converge with second order, evolved variables with them") {
  for (const auto& name : integrator_names()) {
    CAPTURE(name);
    const double coarse = error_after_one_period(name.c_str(), 50),
                 fine = error_after_one_period(name.c_str(), 100);
    // x(T) itself is stationary in the phase error: its order is four.
    CHECK(coarse / fine > 3.8);
    CHECK(fine < 1e-3);
  }
}

TEST_CASE("leapfrog keeps the energy of an oscillator without drift") {
  Oscillators system({1.0}, 0);
  system.update_accelerations(0);
  const auto integrator = make_integrator("leapfrog");
  double largest = 0;
  for (int i = 0; i < 100000; ++i) {
    integrator->step(system, i * 0.1, 0.1);
    if (i % 3 == 0) continue;  // looked at or not, the motion is the same
    integrator->complete(system, (i + 1) * 0.1);
    const double x = system.positions()[0], v = system.velocities()[0];
    largest = std::max(largest, std::abs(0.5 * (x * x + v * v) - 0.5));
  }
  CHECK(largest < 0.5 * 0.1 * 0.1);
}

TEST_CASE("central differences and leapfrog walk the same path") {
  Oscillators a({1.0, 3.0}, 0.2), b({1.0, 3.0}, 0.2);
  a.update_accelerations(0);
  b.update_accelerations(0);
  const auto one = make_integrator("leapfrog"), two = make_integrator("central_difference");
  for (int i = 0; i < 200; ++i) {
    const double dt = i % 2 ? 0.05 : 0.07;  // changing steps too
    one->step(a, 0, dt);
    two->step(b, 0, dt);
    for (std::size_t k = 0; k < 2; ++k)
      CHECK(a.positions()[k] == doctest::Approx(b.positions()[k]).epsilon(1e-12));
  }
}

TEST_CASE("unknown integrators are refused with the valid names") {
  CHECK_THROWS_WITH_AS(make_integrator("euler"), doctest::Contains("leapfrog, central_difference"),
                       InputError);
}

TEST_CASE("relaxation finds its damping and the equilibrium of stiff and soft modes") {
  const std::vector<double> frequencies = {1.0, 4.0, 30.0, 100.0};
  Oscillators system(frequencies, 5.0);
  system.update_accelerations(0);
  Relaxation relaxation(system);
  int steps = 0;
  const double dt = 0.9 * system.stable_step();
  do {
    relaxation.step(steps * dt, dt);
  } while (++steps < 20000 && (relaxation.force_norm() > 1e-9 || relaxation.remaining_motion() > 1e-6));
  for (std::size_t i = 0; i < frequencies.size(); ++i)
    CHECK(system.positions()[i] == doctest::Approx(5.0 / (frequencies[i] * frequencies[i])).epsilon(1e-8));
  // The period of the slowest mode is 349 steps: near-critical damping takes a few of them.
  CHECK(steps < 5000);
}

TEST_CASE("sums over flat arrays are right past a block's end") {
  const std::size_t n = 10007;
  std::vector<double> w(n, 0.5), x(n), y(n, 2.0);
  for (std::size_t i = 0; i < n; ++i) x[i] = static_cast<double>(i);
  CHECK(weighted_dot(w, x, y) == static_cast<double>(n) * static_cast<double>(n - 1) / 2);
}
