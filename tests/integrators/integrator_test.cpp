#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <taut/base/error.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/integrators/relax.hpp>
#include <taut/integrators/vector_ops.hpp>
#include <vector>

using namespace taut;

namespace {

// Those of the library: one of the tests adds another.
const std::vector<std::string> ours = {"leapfrog", "central_difference", "tvd_rk2", "ssp_rk3"};

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
        y_rate_(w_.size()) {
    set_motion(x_, v_, a_, m_);
    add_variable(y_, y_rate_);
    update(0);
  }
  void update_rates(double) override { std::copy(v_.begin(), v_.end(), y_rate_.begin()); }
  void update_accelerations(double t) override {
    for (std::size_t i = 0; i < x_.size(); ++i) a_[i] = g_ - w_[i] * w_[i] * x_[i];
    times.push_back(t);
  }
  void constrain_velocities(double) override {
    for (double& v : v_) v *= drag;
  }
  bool constraints_project() const override { return drag != 1; }
  void begin_step(double t, double dt) override {
    CHECK_FALSE(open);
    CHECK(dt > 0);
    CHECK(t == begun);
    open = true;
    begun = t + dt;
  }
  void commit() override {
    CHECK(open);
    open = false;
    ++committed;
    // The last update was that of the end.
    CHECK(times.back() == begun);
  }
  Fastest fastest() const override { return {.frequency = w_.back()}; }
  const std::vector<double>& followed() const { return y_; }

  double drag = 1;  // a constraint that makes something of what it finds
  bool open = false;
  double begun = 0;
  int committed = 0;
  std::vector<double> times;

 private:
  std::vector<double> w_;
  double g_;
  std::vector<double> x_, v_, a_, m_, y_, y_rate_;
};

void run(Oscillators& system, Integrator& integrator, double dt, int steps) {
  for (int i = 0; i < steps; ++i) integrator.step(system, system.begun, dt);
  integrator.complete(system, system.begun);
}

double error_after_some_time(const std::string& name, int steps) {
  Oscillators system({1.0}, 0);
  const auto integrator = make_integrator(name);
  run(system, *integrator, 1.0 / steps, steps);
  return std::abs(system.positions()[0] - std::cos(1.0)) + std::abs(system.velocities()[0] + std::sin(1.0)) +
         std::abs(system.followed()[0] - std::cos(1.0));
}

}  // namespace

TEST_CASE("integrators converge with their order, other variables with them") {
  for (const auto& name : ours) {
    CAPTURE(name);
    const double order = name == "ssp_rk3" ? 3 : 2;
    const double coarse = error_after_some_time(name, 50), fine = error_after_some_time(name, 100);
    CHECK(std::log2(coarse / fine) == doctest::Approx(order).epsilon(0.03));
    CHECK(fine < 1e-4);
  }
}

TEST_CASE("integrators bracket each step once, and end with the rates of its end") {
  for (const auto& name : ours) {
    CAPTURE(name);
    Oscillators system({1.0, 2.0}, 0.5);
    const auto integrator = make_integrator(name);
    run(system, *integrator, 0.125, 7);
    CHECK(system.committed == 7);
    CHECK_FALSE(system.open);
  }
}

TEST_CASE("oscillations stay bounded up to the step that an integrator states, and no farther") {
  for (const auto& name : ours) {
    CAPTURE(name);
    const double stated = make_integrator(name)->limits().frequency;
    // Growth e^2 in 10^4 steps: next to nothing beyond the limits of those that have one, and what tvd_rk2
    // says.
    const auto bounded = [&](double dt) {
      Oscillators system({1.0}, 0);
      const auto integrator = make_integrator(name);
      for (int i = 0; i < 10000; ++i) {
        integrator->step(system, system.begun, dt);
        if (!(std::abs(system.positions()[0]) < std::exp(2.0))) return false;
      }
      return true;
    };
    double low = 0.5 * stated, high = 1.5 * stated;
    REQUIRE(bounded(low));
    REQUIRE_FALSE(bounded(high));
    while (high - low > 1e-3 * stated) (bounded((low + high) / 2) ? low : high) = (low + high) / 2;
    CHECK(low == doctest::Approx(stated).epsilon(0.03));
  }
}

TEST_CASE("the largest step follows from the limits and from what is fastest") {
  CHECK(stable_step({2, 1}, {.frequency = 10}) == 0.2);
  CHECK(stable_step({2, 1}, {.wave_speed = 100, .length = 3}) == 0.03);
  CHECK(stable_step({2, 0.5}, {.frequency = 10, .wave_speed = 100, .length = 3}) == 0.015);
  CHECK(stable_step({2, 1}, {.frequency = 10, .wave_speed = 1, .length = 3}) == 0.2);
  CHECK(std::isinf(stable_step({2, 1}, {})));
  CHECK(std::isnan(stable_step({2, 1}, {.frequency = std::nan("")})));
  CHECK(std::isnan(stable_step({2, 1}, {.frequency = 1, .wave_speed = std::nan("")})));
}

TEST_CASE("leapfrog keeps the energy of an oscillator without drift") {
  Oscillators system({1.0}, 0);
  const auto integrator = make_integrator("leapfrog");
  double largest = 0;
  for (int i = 0; i < 100000; ++i) {
    integrator->step(system, system.begun, 0.1);
    if (i % 3 == 0) continue;  // looked at or not, the motion is the same
    integrator->complete(system, system.begun);
    const double x = system.positions()[0], v = system.velocities()[0];
    largest = std::max(largest, std::abs(0.5 * (x * x + v * v) - 0.5));
  }
  CHECK(largest < 0.5 * 0.1 * 0.1);
}

TEST_CASE("looking at velocities does not change the bits of what follows") {
  for (const auto& name : ours)
    for (const double drag : {1.0, 0.999}) {
      CAPTURE(name);
      CAPTURE(drag);
      // Enough of them that vector loops have a rest.
      std::vector<double> frequencies(13);
      for (std::size_t i = 0; i < frequencies.size(); ++i) frequencies[i] = 1 + 0.37 * static_cast<double>(i);
      Oscillators seen(frequencies, 0.3), unseen(frequencies, 0.3);
      seen.drag = unseen.drag = drag;
      const auto one = make_integrator(name), two = make_integrator(name);
      for (int i = 0; i < 50; ++i) {
        const double dt = i % 7 ? 0.011 : 0.013;
        one->step(seen, seen.begun, dt);
        two->step(unseen, unseen.begun, dt);
        if (i % 3 == 0) one->complete(seen, seen.begun);
        if (i % 6 == 0) one->complete(seen, seen.begun);
      }
      two->complete(unseen, unseen.begun);
      one->complete(seen, seen.begun);
      CHECK(std::ranges::equal(seen.positions(), unseen.positions()));
      CHECK(std::ranges::equal(seen.velocities(), unseen.velocities()));
      CHECK(seen.followed() == unseen.followed());
    }
}

TEST_CASE("central differences and leapfrog walk the same path") {
  Oscillators a({1.0, 3.0}, 0.2), b({1.0, 3.0}, 0.2);
  const auto one = make_integrator("leapfrog"), two = make_integrator("central_difference");
  for (int i = 0; i < 200; ++i) {
    const double dt = i % 2 ? 0.05 : 0.07;  // changing steps too
    one->step(a, a.begun, dt);
    two->step(b, b.begun, dt);
    for (std::size_t k = 0; k < 2; ++k)
      CHECK(a.positions()[k] == doctest::Approx(b.positions()[k]).epsilon(1e-12));
  }
}

TEST_CASE("unknown integrators are refused with the valid names") {
  CHECK_THROWS_WITH_AS(make_integrator("euler"),
                       doctest::Contains("leapfrog, central_difference, tvd_rk2, ssp_rk3"), InputError);
}

namespace {
/// x += dt v, v += dt a with the new a: of first order.
class SymplecticEuler final : public Integrator {
 public:
  StepLimits limits() const override { return step_limits(2); }

 private:
  void advance(Dynamics& system, double t, double dt) override {
    add_scaled(system.positions(), dt, system.velocities());
    system.update(t + dt);
    add_scaled(system.velocities(), dt, system.accelerations());
  }
};
}  // namespace

TEST_CASE("a program registers an integrator of its own") {
  const std::size_t before = integrators().size();
  const auto make = [] { return std::make_unique<SymplecticEuler>(); };
  CHECK_THROWS_WITH_AS(register_integrator({"", "none", make}), doctest::Contains("name"), InputError);
  CHECK_THROWS_WITH_AS(register_integrator({"nothing", "", {}}), doctest::Contains("nothing makes"),
                       InputError);
  CHECK_THROWS_WITH_AS(register_integrator({"leapfrog", "again", make}), doctest::Contains("leapfrog"),
                       InputError);
  CHECK(integrators().size() == before);
}

TEST_CASE("a registered integrator is found by its name") {
  register_integrator(
      {"symplectic_euler", "of first order", [] { return std::make_unique<SymplecticEuler>(); }});
  CHECK(integrator_names().back() == "symplectic_euler");
  Oscillators system({1.0}, 0);
  const auto integrator = make_integrator("symplectic_euler");
  run(system, *integrator, 1e-3, 1000);
  CHECK(system.positions()[0] == doctest::Approx(std::cos(1.0)).epsilon(1e-3));
  CHECK_THROWS_WITH_AS(make_integrator("euler"), doctest::Contains("ssp_rk3, symplectic_euler"), InputError);
}

TEST_CASE("relaxation finds its damping and the equilibrium of stiff and soft modes") {
  const std::vector<double> frequencies = {1.0, 4.0, 30.0, 100.0};
  Oscillators system(frequencies, 5.0);
  Relaxation relaxation(system);
  int steps = 0;
  const double dt = 0.9 * stable_step(leapfrog_limits, system.fastest());
  do {
    relaxation.step(system.begun, dt);
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
