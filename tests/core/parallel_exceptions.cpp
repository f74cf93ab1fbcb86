// F6: what a user's material throws on any thread reaches the caller, out of every form; and the loops that
// carry it.
#include <doctest/doctest.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/taut.hpp>
#include <vector>

using namespace taut;

namespace {

struct Boom : std::runtime_error {
  Boom() : std::runtime_error("boom") {}
};

/// Throws at the call that brings it down to zero.
struct Fuse {
  std::atomic<long> left{-1};
  void burn() {
    long now = left.load();
    while (now > 0)
      if (left.compare_exchange_weak(now, now - 1)) {
        if (now == 1) throw Boom();
        return;
      }
  }
};

const MaterialParameters rubber{.E = 1e6, .nu = 0.3, .density = 1000};

class Elastic final : public Hyperelastic<2> {
 public:
  explicit Elastic(std::shared_ptr<Fuse> fuse)
      : Hyperelastic<2>(rubber),
        fuse_(std::move(fuse)),
        law_(std::dynamic_pointer_cast<const Hyperelastic<2>>(make_material<2>("neo_hookean", rubber))) {}
  std::string_view name() const override { return "fused_elastic"; }
  using Hyperelastic<2>::wave_speed;
  double wave_speed(double a, double b, double c, double d) const override {
    return law_->wave_speed(a, b, c, d);
  }
  void stress(const StressBlock<2>& block) const override {
    fuse_->burn();
    law_->stress(block);
  }

 private:
  std::shared_ptr<Fuse> fuse_;
  std::shared_ptr<const Hyperelastic<2>> law_;
};

class Rate final : public Hypoelastic<2> {
 public:
  Rate(std::shared_ptr<Fuse> fuse, bool in_rate)
      : Hypoelastic<2>(rubber),
        fuse_(std::move(fuse)),
        in_rate_(in_rate),
        law_(std::dynamic_pointer_cast<const Hypoelastic<2>>(make_material<2>("hypoelastic", rubber))) {}
  std::string_view name() const override { return "fused_rate"; }
  using Hypoelastic<2>::wave_speed;
  double wave_speed(double a, double b, double c, double d) const override {
    return law_->wave_speed(a, b, c, d);
  }
  void rate(const RateBlock<2>& block) const override {
    if (in_rate_) fuse_->burn();
    law_->rate(block);
  }
  void stress(const RateBlock<2>& block) const override {
    if (!in_rate_) fuse_->burn();
    law_->stress(block);
  }

 private:
  std::shared_ptr<Fuse> fuse_;
  bool in_rate_;
  std::shared_ptr<const Hypoelastic<2>> law_;
};

class Threads {
 public:
  explicit Threads(int n) : before_(omp_get_max_threads()) { omp_set_num_threads(n); }
  ~Threads() { omp_set_num_threads(before_); }

 private:
  int before_;
};

// Enough particles for many threads.
Simulation<2> plate(const Method& method, std::shared_ptr<const Material<2>> material) {
  Simulation<2> s(make_cloud(box<2>({0, 0}, {1, 0.5}), {.dx = 1.0 / 110}), std::move(material), method);
  s.set_velocity([](const Vec<2>& X) { return Vec<2>(0.1 * X[0], 0); });
  return s;
}

std::string message_of(auto&& f) {
  try {
    f();
  } catch (const RunError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("F6: a material that throws does not end the program") {
  struct Form {
    const char* formulation;
    int law;  // 0: stress of F; 1: rates; 2: stress of a rate form
  };
  for (const Form& form :
       {Form{"tl_displacement", 0}, Form{"tl_bond_associated", 0}, Form{"tl_stress_points", 0},
        Form{"ul_basic", 1}, Form{"ul_basic", 2}, Form{"ul_artificial_stress", 1}})
    for (const int threads : {1, 2, 3}) {
      CAPTURE(form.formulation);
      CAPTURE(form.law);
      CAPTURE(threads);
      const Threads now(threads);
      const auto fuse = std::make_shared<Fuse>();
      std::shared_ptr<const Material<2>> material;
      if (form.law == 0)
        material = std::make_shared<const Elastic>(fuse);
      else
        material = std::make_shared<const Rate>(fuse, form.law == 1);
      Method method{.formulation = form.formulation};
      if (form.law != 0) method.support_dx = 2.4;
      auto s = plate(method, material);
      s.prepare();
      const double dt = 1e-5;
      // In the first evaluation, before any step: all is as it was, and the run can be had again.
      fuse->left = 40;
      CHECK_THROWS_AS(s.run(2 * dt, {.max_step = dt}), Boom);
      REQUIRE(fuse->left == 0);
      fuse->left = -1;
      CHECK(s.time() == 0);
      auto other = plate(method, material);
      REQUIRE(other.run(2 * dt, {.max_step = dt}).status == Status::ok);
      REQUIRE(s.run(2 * dt, {.max_step = dt}).status == Status::ok);
      bool same = true;
      for (std::size_t i = 0; i < s.size(); ++i) same = same && s.displacement(i) == other.displacement(i);
      CHECK(same);
      // In a step: what is left is no state of any time. It can be looked at.
      const long evaluation =
          form.law == 0 && form.formulation != std::string("tl_displacement") ? 5000 : 150;
      fuse->left = evaluation;
      CHECK_THROWS_AS(s.run(1e3 * dt, {.max_step = dt}), Boom);
      fuse->left = -1;
      CHECK(std::isfinite(s.displacement(0)[0]));
      const std::string refusal = message_of([&] { s.run(dt); });
      CAPTURE(refusal);
      CHECK(refusal.find("cannot go on") != refusal.npos);
      CHECK(refusal.find("boom") != refusal.npos);
      CHECK_THROWS_AS(s.relax(), RunError);
    }
}

TEST_CASE("F6: looking at a state whose material throws leaves it as it is") {
  for (const char* form : {"tl_displacement", "tl_bond_associated", "tl_stress_points"}) {
    CAPTURE(form);
    const Threads now(2);
    const auto fuse = std::make_shared<Fuse>();
    auto s = plate({.formulation = form}, std::make_shared<const Elastic>(fuse));
    s.run(1e-5, {.max_step = 1e-5});
    const double energy = s.strain_energy();
    for (const long call : {1, 20, 60}) {
      fuse->left = call;
      CHECK_THROWS_AS(s.strain_energy(), Boom);
      fuse->left = -1;
      CHECK(s.strain_energy() == energy);
    }
    CHECK(s.run(1e-5, {.max_step = 1e-5}).status == Status::ok);
  }
}

TEST_CASE("parallel loops visit every index once and carry one exception out") {
  for (const int threads : {1, 2, 5}) {
    const Threads now(threads);
    constexpr int n = 1000;
    const auto all_once = [](const std::vector<int>& seen) {
      return std::all_of(seen.begin(), seen.end(), [](int k) { return k == 1; });
    };
    std::vector<int> seen(n);
    parallel_for(n, true, [&](int i) { ++seen[static_cast<std::size_t>(i)]; });
    CHECK(all_once(seen));
    seen.assign(n, 0);
    parallel_for_dynamic(n, 7, true, [&](int i) { ++seen[static_cast<std::size_t>(i)]; });
    CHECK(all_once(seen));
    int sum = 0;
    parallel_for(
        n, true, 0, [](int i, int& mine) { mine += i; }, [&](int mine) { sum += mine; });
    CHECK(sum == n * (n - 1) / 2);
    std::atomic<int> calls{0};
    on_threads(true, [&] { ++calls; });
    CHECK(calls == threads);

    const auto boom = [](int i) {
      if (i % 100 == 99) throw Boom();
    };
    CHECK_THROWS_AS(parallel_for(n, true, boom), Boom);
    CHECK_THROWS_AS(parallel_for_dynamic(n, 3, true, boom), Boom);
    CHECK_THROWS_AS(parallel_for(
                        n, true, 0, [&](int i, int&) { boom(i); }, [](int) {}),
                    Boom);
    CHECK_THROWS_AS(parallel_for(
                        n, true, 0, [](int, int&) {}, [](int) { throw std::bad_alloc(); }),
                    std::bad_alloc);
    CHECK_THROWS_AS(on_threads(true, [] { throw Boom(); }), Boom);
  }
}

TEST_CASE("F6: what functions throw while pairs are filtered reaches the caller") {
  const auto cloud = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 1.0 / 80});
  Field X(cloud.size(), 2);
  for (std::size_t i = 0; i < cloud.size(); ++i) X.set_vec<2>(i, cloud.X[i]);
  PairList list = find_pairs<2>(points_of<2>(X, static_cast<Index>(cloud.size())), 1.5 * cloud.dx);
  CHECK_THROWS_AS(filter_pairs(list, [](Index a, Index) { return a < 5000 ? true : throw Boom(); }), Boom);
  CHECK_THROWS_AS(filter_pairs(list, {}), InputError);
}
