// The ways to keep pair vectors against each other: what differs is memory and round-off, not forces.
#include <doctest/doctest.h>
#include <omp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>
#include <taut/base/error.hpp>
#include <taut/formulations/assembly.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/operators/pair_payload.hpp>
#include <vector>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D>
Cloud<D> body(double jitter, Lattice lattice = Lattice::node_centred) {
  // Large enough for several threads (3D), and rows that are no multiple of a slice.
  constexpr double dx = D == 3 ? 1.0 / 17 : D == 2 ? 1.0 / 77 : 1.0 / 301;
  return make_cloud(box<D>(Vec<D>::Zero(), Vec<D>::Ones()), {.dx = dx, .lattice = lattice, .jitter = jitter});
}

// A round body: rows of all lengths, slots that are gathered, slices across rows.
Cloud<3> ball() {
  return make_cloud(sphere<3>({0, 0, 0}, 0.5), {.dx = 1.0 / 20, .lattice = Lattice::cell_centred});
}

struct Setting {
  const char* operators = "corrected";
  double support_dx = 1.5;
  bool mirror = false;
};

template <int D>
struct Body {
  Particles<D> p;
  Constraints<D> constraints;
  Loads<D> loads;
  Method method = with_defaults({});
  std::unique_ptr<Formulation<D>> form;

  Body(const Cloud<D>& cloud, PairPrecision precision, const Setting& setting = {}) {
    method.operators = setting.operators;
    method.support_dx = setting.support_dx;
    method.pair_precision = precision;
    std::vector<typename MirrorMap<D>::Plane> planes;
    if (setting.mirror) planes.push_back({0, 0.0, 0});
    const double reach = setting.support_dx * cloud.dx;
    p = assemble<D>(cloud, {make_material<D>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000})},
                    std::vector<std::uint8_t>(cloud.size(), 0), {planes, {}, reach});
    form = make_formulation<D>({p, constraints, loads, method});
    for (Index i = 0; i < p.n; ++i) {
      const Vec<D> X = p.X.template vec<D>(i);
      Vec<D> u;
      for (int d = 0; d < D; ++d) u[d] = 0.05 * std::sin(2 * X[d] + 3 * X[(d + 1) % D]) * X[0];
      p.u.template set_vec<D>(i, u);
    }
    form->update_accelerations(0);
  }
  Vec<D> force(Index i) const { return p.m.component(0)[i] * p.a.template vec<D>(i); }
};

// Largest difference of the forces over the largest force.
template <int D>
double difference(const Cloud<D>& cloud, PairPrecision precision, const Setting& setting = {}) {
  const Body<D> exact(cloud, PairPrecision::double_precision, setting), other(cloud, precision, setting);
  double largest = 0, error = 0;
  for (Index i = 0; i < exact.p.n; ++i) {
    largest = std::max(largest, exact.force(i).norm());
    error = std::max(error, (exact.force(i) - other.force(i)).norm());
  }
  CHECK(largest > 0);
  return error / largest;
}

template <int D>
void check_payloads(const Cloud<D>& cloud, const Setting& setting = {}) {
  CHECK(difference(cloud, PairPrecision::shared, setting) < 1e-11);
  CHECK(difference(cloud, PairPrecision::recomputed, setting) < 1e-8);
  const double single = difference(cloud, PairPrecision::single_precision, setting);
  CHECK(single < 1e-5);
  CHECK(single > 1e-12);  // were it not, the payload would not be what it says
}

constexpr PairPrecision payloads[] = {PairPrecision::single_precision, PairPrecision::double_precision,
                                      PairPrecision::shared, PairPrecision::recomputed};

}  // namespace

TEST_CASE("forces do not depend on how pair vectors are kept") {
  SUBCASE("1D") { check_payloads(body<1>(0)); }
  SUBCASE("1D, jittered") { check_payloads(body<1>(0.2)); }
  SUBCASE("2D") { check_payloads(body<2>(0), {.support_dx = 2.4}); }
  SUBCASE("2D, jittered") { check_payloads(body<2>(0.2)); }
  SUBCASE("3D") { check_payloads(body<3>(0)); }
  SUBCASE("3D, jittered") { check_payloads(body<3>(0.2), {.support_dx = 2.1}); }
  SUBCASE("ball") { check_payloads(ball(), {.support_dx = 2.1}); }
  SUBCASE("standard operator") { check_payloads(body<2>(0), {.operators = "standard", .support_dx = 2.6}); }
  SUBCASE("symmetry plane") { check_payloads(body<2>(0), {.support_dx = 2.4, .mirror = true}); }
}

TEST_CASE("a lattice shares its pair vectors, an unordered cloud does not, and automatic knows") {
  const Body<3> lattice(body<3>(0), PairPrecision::shared),
      stored(body<3>(0), PairPrecision::single_precision);
  CHECK(lattice.form->bytes() < 0.5 * static_cast<double>(stored.form->bytes()));
  CHECK(Body<3>(body<3>(0), PairPrecision::automatic).form->bytes() == lattice.form->bytes());
  const auto jittered = body<3>(0.2);
  CHECK(Body<3>(jittered, PairPrecision::automatic).form->bytes() ==
        Body<3>(jittered, PairPrecision::single_precision).form->bytes());
}

TEST_CASE("codes of shared vectors name their components, and a lattice leaves many out") {
  Method method = with_defaults({});
  method.pair_precision = PairPrecision::shared;
  // A corner that no binary fraction meets.
  const auto cloud = make_cloud(box<3>({0.1, 0.7, -0.3}, {1.1, 1.7, 0.7}), {.dx = 1.0 / 17});
  const Discretised<3> lattice(cloud, method);
  for (const SharedSlot& slot : lattice.op.slots)
    for (int d = 0; d < 3; ++d) {
      const double* block = lattice.op.blocks.data() + (slot.code >> 3) * (3 * lanes) + d * lanes;
      const bool any = std::any_of(block, block + lanes, [](double g) { return g != 0; });
      CHECK(any == static_cast<bool>(slot.code >> d & 1));
    }
  Index kept = 0, slots = 0;
  for (const SharedSlots& of : lattice.op.slice_slots)
    for (std::int64_t k = of.begin; k < of.begin + of.count; ++k, ++slots)
      kept += std::popcount(static_cast<unsigned>(lattice.op.slots[static_cast<std::size_t>(k)].code & 7));
  // Of 18 neighbours six lie along an axis and twelve in a plane: 30 of 54 components.
  CHECK(static_cast<double>(kept) / (3 * static_cast<double>(slots)) < 0.6);
}

TEST_CASE("slices that are alike keep their slots once, and each finds its neighbours in the list's order") {
  Method method = with_defaults({});
  method.pair_precision = PairPrecision::shared;
  const auto check = [&](const Discretised<3>& body) {
    // A field of the particles' own numbers: what a slot reads of it are its neighbours.
    Field number(static_cast<std::size_t>(body.particles.total), 1);
    std::iota(number.flat().begin(), number.flat().end(), 0.0);
    const SharedVectors<3> vectors{body.op.slice_slots.data(), body.op.slots.data(), body.op.blocks.data()};
    bool same = true;
    for (Index s = 0; s < body.pairs.slices(); ++s) {
      std::vector<double> shared, listed;
      const auto into = [&](std::vector<double>& neighbours) {
        return [&](std::int64_t, auto&& at) {
          const Pack b = at(number.component(0));
          for (int l = 0; l < lanes; ++l) neighbours.push_back(b[l]);
        };
      };
      for_slots(body.pairs, vectors, s, into(shared));
      for_slots(body.pairs, s, into(listed));
      same = same && shared == listed && furthest(body.pairs, vectors, s) == furthest(body.pairs, s);
    }
    CHECK(same);
  };
  const Discretised<3> lattice(make_cloud(box<3>(Vec<3>::Zero(), Vec<3>::Ones()), {.dx = 1.0 / 32}), method);
  check(lattice);
  CHECK(static_cast<double>(lattice.op.slots.size()) < 0.25 * static_cast<double>(lattice.pairs.slots()));
  const Discretised<3> jittered(
      make_cloud(box<3>(Vec<3>::Zero(), Vec<3>::Ones()), {.dx = 1.0 / 12, .jitter = 0.2}), method);
  REQUIRE(jittered.pairs.contiguous_fraction() < 1);
  check(jittered);
  CHECK(static_cast<double>(jittered.op.slots.size()) > 0.9 * static_cast<double>(jittered.pairs.slots()));
}

TEST_CASE("forces of every payload have the same bits for one and two threads") {
  const int before = omp_get_max_threads();
  for (const double jitter : {0.0, 0.2})
    for (const PairPrecision precision : payloads) {
      const auto cloud = body<3>(jitter);
      omp_set_num_threads(1);
      const Body<3> one(cloud, precision);
      omp_set_num_threads(2);
      const Body<3> two(cloud, precision);
      omp_set_num_threads(before);
      REQUIRE(one.p.n > 4096);  // enough for the loops to be shared out
      bool same = one.form->fastest().frequency == two.form->fastest().frequency;
      for (Index i = 0; i < one.p.n; ++i) same = same && one.p.a.vec<3>(i) == two.p.a.vec<3>(i);
      CHECK(same);
    }
}

TEST_CASE("internal forces of every payload add up to nothing") {
  for (const double jitter : {0.0, 0.2})
    for (const PairPrecision precision : payloads) {
      const Body<3> b(body<3>(jitter), precision);
      Vec<3> sum = Vec<3>::Zero();
      double scale = 0;
      for (Index i = 0; i < b.p.n; ++i) {
        sum += b.force(i);
        scale += b.force(i).norm();
      }
      CHECK(sum.norm() < 1e-12 * scale);
    }
}

TEST_CASE("corrected operators reproduce linear fields with every payload") {
  for (const double jitter : {0.0, 0.2})
    for (const PairPrecision precision : payloads) {
      Body<3> b(body<3>(jitter), precision);
      Mat<3> F;
      F << 1.1, 0.2, -0.1, 0.05, 0.9, 0.15, -0.2, 0.1, 1.05;
      for (Index i = 0; i < b.p.n; ++i) b.p.u.set_vec<3>(i, F * b.p.X.vec<3>(i) - b.p.X.vec<3>(i));
      double error = 0;
      for (Index i = 0; i < b.p.n; ++i) error = std::max(error, (b.form->deformation_gradient(i) - F).norm());
      CHECK(error < 1e-12);
    }
}
