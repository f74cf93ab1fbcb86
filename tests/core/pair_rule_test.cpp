// Pairs with the body between them: slits, gaps, notches.
#include <doctest/doctest.h>

#include <taut/geometry/occupancy.hpp>
#include <taut/geometry/visibility.hpp>
#include <taut/particles/interfaces.hpp>
#include <taut/particles/pair_rule.hpp>

#include "discretised.hpp"

using namespace taut;

namespace {

std::shared_ptr<const Material<2>> rubber() {
  return make_material<2>("linear_elastic", {.E = 1e6, .nu = 0, .density = 1000, .plane = Plane::stress});
}

constexpr double dx = 0.1;

/// A strip of 3 x 1 with a slit along its middle, `cells` wide, from x = 1 on.
Cloud<2> slit_strip(int cells, Lattice lattice = Lattice::node_centred, double jitter = 0) {
  const double half = cells * dx / 2;
  return make_cloud(box<2>({0, 0}, {3, 1 + cells * dx}) - box<2>({1, 0.5}, {4, 0.5 + 2 * half}),
                    {.dx = dx, .lattice = lattice, .jitter = jitter});
}

/// Pairs that a simulation has with a method less those that lie in each other's sight.
std::int64_t pairs_of(const Cloud<2>& cloud, const Method& method) {
  Simulation<2> s(cloud, rubber(), with_defaults(method));
  s.prepare();
  return s.pairs();
}

/// Deflection of the tip of the lower of two arms that lie `gap` apart, both held at x = 0.
double arm(double gap, const Method& method, bool clouds_alone) {
  const Shape<2> low = box<2>({0, 0}, {2, 0.4}), high = box<2>({0, 0.4 + gap}, {2, 0.8 + gap});
  Simulation<2> s(make_cloud(clouds_alone ? low : low | high, {.dx = dx}), rubber(), method);
  s.clamp([](const Vec<2>& X) { return X[0] < 1e-9; });
  s.load([](const Vec<2>& X) { return X[0] > 2 - 1e-9 && X[1] < 0.4 + 1e-9; }, {0, -10});
  CHECK(s.relax({.tolerance = 1e-7}).status == Status::ok);
  return s.displacement_at({2, 0.2})[1];
}

}  // namespace

TEST_CASE("visibility: ways stay in the closed union of cells") {
  // 4 x 3 cells with a slit of one cell from the right: cells (2, 1) and (3, 1) are empty.
  std::vector<std::uint8_t> label(12, 1);
  label[4 + 2] = label[4 + 3] = 0;
  const Visibility<2> v({4, 3}, label, 2);
  const auto sees = [&](Index ax, Index ay, Index bx, Index by) {
    const bool there = v.connects({2 * ax, 2 * ay}, {2 * bx, 2 * by}, v.any);
    CHECK(v.connects({2 * bx, 2 * by}, {2 * ax, 2 * ay}, v.any) == there);
    return there;
  };
  CHECK(sees(0, 0, 1, 1));
  CHECK(sees(1, 1, 2, 2));        // ends at the slit's corner
  CHECK(sees(2, 1, 2, 2));        // along the slit's end
  CHECK(sees(2, 1, 4, 1));        // along its lower side
  CHECK_FALSE(sees(3, 1, 3, 2));  // across
  CHECK_FALSE(sees(2, 1, 3, 2));
  CHECK_FALSE(sees(4, 1, 4, 2));  // along the body's end, where there is no cell
  CHECK_FALSE(sees(3, 0, 3, 3));
  CHECK(sees(1, 0, 3, 1));
  CHECK_FALSE(sees(1, 2, 4, 1));
  CHECK_FALSE(v.connects({5, 3}, {5, 1}, v.any));  // from the middle of an empty cell
  CHECK(v.connects({1, 1}, {3, 3}, v.any));        // middles of cells, through a corner
  CHECK_FALSE(v.connects({3, 3}, {3, 3}, 2));      // of another label
}

TEST_CASE("visibility: what each particle sees by itself is what the cells say") {
  // The short cut for bodies that are uniform around a site gives what the long way gives.
  std::vector<std::uint8_t> label(12 * 12 * 12, 1);
  for (std::size_t k = 0; k < label.size(); k += 7) label[k] = static_cast<std::uint8_t>(k % 3);
  for (std::size_t k = 0; k < label.size(); ++k)
    if (k / 144 < 6) label[k] = 1;
  const Visibility<3> quick({12, 12, 12}, label, 2), slow({12, 12, 12}, label, 40);
  std::int64_t differences = 0, seen = 0;
  for (Index z = 0; z <= 24; z += 2)
    for (Index y = 0; y <= 24; y += 2)
      for (Index x = 0; x <= 24; x += 2)
        for (Index d = 0; d < 27; ++d) {
          const Site<3> a{x, y, z}, b{x + 2 * (d % 3), y + 2 * (d / 3 % 3) - 2, z + 2 * (d / 9) - 2};
          for (const std::uint8_t l : {0, 1, 2}) {
            differences += quick.connects(a, b, l) != slow.connects(a, b, l);
            seen += quick.connects(a, b, l);
          }
        }
  CHECK(differences == 0);
  CHECK(seen > 1000);
}

TEST_CASE("pairs across slits of one cell and two do not count") {
  for (const Lattice lattice : {Lattice::node_centred, Lattice::cell_centred})
    for (const double jitter : {0.0, 0.2})
      for (const int cells : {1, 2})
        for (const double support : {1.5, 2.4}) {
          const Cloud<2> cloud = slit_strip(cells, lattice, jitter);
          Particles<2> p = assemble<2>(cloud, {rubber()}, std::vector<std::uint8_t>(cloud.size(), 0),
                                       {{}, {}, support * dx});
          const auto rule = PairRule<2>::make(cloud, p, {}, nullptr, support * dx);
          REQUIRE(rule);
          PairList pairs = find_pairs<2>(points_of<2>(p.X, p.n), support * dx);
          filter_pairs(pairs, [&](Index a, Index b) { return rule->counts(a, b); });
          std::int64_t across = 0, inside = 0, asymmetric = 0;
          const double low = 0.5 + 0.05 * dx, high = 0.5 + cells * dx - 0.05 * dx;
          for (Index a = 0; a < p.n; ++a)
            pairs.for_each(a, [&](Index b, std::int64_t, int) {
              const Vec<2> A = p.X.vec<2>(static_cast<std::size_t>(a)),
                           B = p.X.vec<2>(static_cast<std::size_t>(b));
              const bool opposite = (A[1] < low && B[1] > high) || (A[1] > high && B[1] < low);
              if (opposite && A[0] > 1.05 + 0.3 * dx && B[0] > 1.05 + 0.3 * dx) ++across;
              if (opposite && A[0] < 1 - 0.5 * dx && B[0] < 1 - 0.5 * dx) ++inside;
              asymmetric += pairs.find(b, a) < 0;
            });
          CHECK(across == 0);
          CHECK(asymmetric == 0);
          if (cells == 1 && lattice == Lattice::node_centred) CHECK(inside > 0);
        }
}

TEST_CASE("arms that lie a cell apart move as if each were alone") {
  for (const char* formulation : {"tl_displacement", "tl_bond_associated"})
    for (const double support : {1.5, 2.4})
      for (const int cells : {1, 2}) {
        const Method method{.formulation = formulation, .support_dx = support};
        const double alone = arm(cells * dx, method, true), beside = arm(cells * dx, method, false);
        CHECK(beside == doctest::Approx(alone).epsilon(1e-5));
      }
}

TEST_CASE("bodies without a concave place have all their pairs, to the last bit") {
  const Cloud<2> cloud = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = dx, .jitter = 0.2});
  const Particles<2> p =
      assemble<2>(cloud, {rubber()}, std::vector<std::uint8_t>(cloud.size(), 0), {{}, {}, 1.5 * dx});
  CHECK(PairRule<2>::make(cloud, p, {}, nullptr, 1.5 * dx) == nullptr);
}

TEST_CASE("re-entrant corners are not cut short") {
  const Shape<2> ell = box<2>({0, 0}, {1, 1}) - box<2>({0.5, 0.5}, {1, 1});
  const Cloud<2> cloud = make_cloud(ell, {.dx = dx});
  const std::int64_t all = [&] {
    Cloud<2> bare = cloud;
    bare.body = nullptr;
    bare.B.clear();
    return pairs_of(bare, {});
  }();
  // At R = 1.5 dx: from the corner's neighbour on one face to that on the other, there and back.
  CHECK(pairs_of(cloud, {}) == all - 2);
  // By areas, as clouds from files have it.
  Cloud<2> unknown = cloud;
  unknown.body = nullptr;
  CHECK(pairs_of(unknown, {}) == all - 2);
}

TEST_CASE("clouds without a lattice: areas tell what lies between") {
  for (const int cells : {1, 2})
    for (const double support : {1.5, 2.4}) {
      Cloud<2> cloud = slit_strip(cells);
      const std::int64_t by_lattice = pairs_of(cloud, {.support_dx = support});
      cloud.body = nullptr;
      const double by_areas = static_cast<double>(pairs_of(cloud, {.support_dx = support}));
      CHECK(by_areas == doctest::Approx(static_cast<double>(by_lattice)).epsilon(0.01));
    }
}

TEST_CASE("clouds whose particles have changed places have no lattice") {
  Cloud<2> cloud = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = dx});
  CHECK(lattice_of(cloud) != nullptr);
  Cloud<2> moved = cloud;
  for (Vec<2>& X : moved.X) X = rotation<2>(0.3) * X + Vec<2>(1e3, 0);
  CHECK(lattice_of(moved) != nullptr);
  std::swap(moved.X[3], moved.X[80]);
  CHECK(lattice_of(moved) == nullptr);
  cloud.X.pop_back();
  CHECK(lattice_of(cloud) == nullptr);
}

TEST_CASE("a slit goes on beyond a symmetry plane") {
  // Half of a slit of two cells, which lies on the plane y = 0: its other half is the image's.
  const Shape<2> half = box<2>({0, 0}, {2, 0.5}) - box<2>({1, -1}, {3, dx}),
                 whole = box<2>({0, -0.5}, {2, 0.5}) - box<2>({1, -dx}, {3, dx});
  const Method method{.support_dx = 2.4, .pair_precision = PairPrecision::double_precision};
  Simulation<2> part(make_cloud(half, {.dx = dx}), rubber(), method),
      all(make_cloud(whole, {.dx = dx}), rubber(), method);
  part.symmetry_plane(1, 0);
  for (auto* s : {&part, &all}) {
    s->set_velocity([](const Vec<2>& X) { return Vec<2>(X[0] * X[0], X[0] * X[1]); });
    CHECK(s->run(0.02, {.cfl = 1e3, .max_step = 2e-4}).status == Status::ok);
  }
  double largest = 0, difference = 0;
  for (std::size_t i = 0; i < part.size(); ++i)
    for (std::size_t j = 0; j < all.size(); ++j) {
      if ((part.reference_position(i) - all.reference_position(j)).norm() > 1e-6) continue;
      largest = std::max(largest, all.displacement(j).norm());
      difference = std::max(difference, (part.displacement(i) - all.displacement(j)).norm());
    }
  CHECK(largest > 1e-3);
  CHECK(difference < 1e-9 * largest);
}

TEST_CASE("stresses are not fitted across slits") {
  // The arms above and below the slit are strained differently.
  const Cloud<2> cloud = slit_strip(1);
  for (const char* formulation : {"tl_displacement", "tl_bond_associated"}) {
    Simulation<2> s(cloud, rubber(), {.formulation = formulation});
    s.set_displacement(
        [](const Vec<2>& X) { return Vec<2>(X[1] > 0.55 ? 0.01 * std::max(0.0, X[0] - 1) : 0.0, 0); });
    s.prepare();
    const auto P = StressRecovery<2>(s).first_piola_kirchhoff();
    for (std::size_t i = 0; i < s.size(); ++i) {
      const Vec<2> X = s.reference_position(i);
      if (X[0] < 1.6) continue;  // what the end of the slit is seen from
      CHECK(P[i](0, 0) == doctest::Approx(X[1] > 0.55 ? 1e4 : 0).epsilon(1e-4));
    }
  }
}
