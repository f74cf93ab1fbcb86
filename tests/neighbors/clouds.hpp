#pragma once
// Point clouds for the tests, and the pairs that they have by definition.

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <span>
#include <string>
#include <taut/base/error.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/neighbors/search_variants.hpp>
#include <utility>
#include <vector>

namespace clouds {

using taut::Index;

template <int D>
struct Points {
  std::array<std::vector<double>, D> x;

  Index n() const { return static_cast<Index>(x[0].size()); }
  taut::PointView<D> view() const {
    taut::PointView<D> v;
    for (int d = 0; d < D; ++d) v.x[d] = x[d].data();
    v.n = n();
    return v;
  }
  void add(const std::array<double, D>& p) {
    for (int d = 0; d < D; ++d) x[d].push_back(p[d]);
  }
  void shift(double by) {
    for (auto& c : x)
      for (double& v : c) v += by;
  }
  Points reordered(const std::vector<Index>& order) const {
    Points r;
    for (int d = 0; d < D; ++d)
      for (const Index i : order) r.x[d].push_back(x[d][static_cast<std::size_t>(i)]);
    return r;
  }
};

// std::uniform_real_distribution is not the same everywhere.
inline double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

template <int D>
Points<D> random_cloud(Index n, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  Points<D> p;
  for (Index i = 0; i < n; ++i)
    for (int d = 0; d < D; ++d) p.x[d].push_back(uniform(random));
  return p;
}

// Unit spacing, the first coordinate fastest.
template <int D>
Points<D> lattice(std::array<int, D> count, double jitter = 0, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  Points<D> p;
  Index n = 1;
  for (const int c : count) n *= c;
  for (Index i = 0; i < n; ++i) {
    Index rest = i;
    for (int d = 0; d < D; ++d) {
      p.x[d].push_back(rest % count[d] + jitter * (2 * uniform(random) - 1));
      rest /= count[d];
    }
  }
  return p;
}

// A few dense heaps far from each other.
template <int D>
Points<D> clusters(Index n, unsigned seed = 1) {
  std::mt19937_64 random(seed);
  Points<D> p;
  for (Index i = 0; i < n; ++i)
    for (int d = 0; d < D; ++d) p.x[d].push_back(100 * (i % 3) * (d + 1) + std::pow(uniform(random), 3));
  return p;
}

template <int D>
std::vector<Index> shuffled(Index n, unsigned seed = 7) {
  std::vector<Index> order;
  for (Index i = 0; i < n; ++i) order.push_back(i);
  std::mt19937_64 random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

using Pairs = std::vector<std::pair<Index, Index>>;

// Every operation is rounded, in the order that find_pairs documents; volatile keeps the compiler from fusing
// them.
template <int D>
Pairs brute_force(const Points<D>& p, const std::vector<double>& radii) {
  Pairs pairs;
  for (Index a = 0; a < p.n(); ++a)
    for (Index b = 0; b < p.n(); ++b) {
      if (a == b) continue;
      double d2 = 0;
      for (int d = 0; d < D; ++d) {
        const double dx = p.x[d][a] - p.x[d][b];
        const volatile double square = dx * dx;
        const volatile double sum = d2 + square;
        d2 = sum;
      }
      const double r = std::max(radii[a], radii[b]);
      if (d2 < r * r) pairs.emplace_back(a, b);
    }
  return pairs;
}

inline Pairs pairs_of(const taut::PairList& list) {
  Pairs pairs;
  for (Index a = 0; a < list.particles(); ++a)
    list.for_each(a, [&](Index b, std::int64_t, int) { pairs.emplace_back(a, b); });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

inline bool same_layout(const taut::PairList& a, const taut::PairList& b) {
  if (a.particles() != b.particles() || a.pairs() != b.pairs() || a.slots() != b.slots()) return false;
  for (Index s = 0; s < a.slices(); ++s) {
    if (a.begin(s) != b.begin(s) || a.gathered(s) != b.gathered(s) || a.begin(s + 1) != b.begin(s + 1))
      return false;
    for (std::int64_t k = a.begin(s); k < a.begin(s + 1); ++k) {
      if (a.mask(k) != b.mask(k) || a.first(k) != b.first(k)) return false;
      if (!a.is_contiguous(s, k) && !std::equal(a.block(k), a.block(k) + taut::lanes, b.block(k)))
        return false;
    }
  }
  return true;
}

// What the documentation of PairList promises of any list.
inline void check_invariants(const taut::PairList& list) {
  const auto need = [](bool holds, int line = __builtin_LINE()) {  // an assertion each would take seconds
    if (!holds) FAIL("invariant in line ", line);
  };
  const auto padded = static_cast<Index>(taut::padded(static_cast<std::size_t>(list.particles())));
  need(list.slices() * taut::lanes == padded);
  std::int64_t bits = 0, slots = 0;
  for (Index s = 0; s < list.slices(); ++s) {
    need(list.begin(s) == slots);
    need(list.begin(s) <= list.gathered(s));
    need(list.gathered(s) <= list.begin(s + 1));
    slots = list.begin(s + 1);
    for (std::int64_t k = list.begin(s); k < list.begin(s + 1); ++k) {
      need(list.mask(k) != 0);
      for (int l = 0; l < taut::lanes; ++l) {
        const Index a = s * taut::lanes + l;
        const bool pair = list.mask(k) >> l & 1;
        const Index b = list.is_contiguous(s, k) ? list.first(k) + l : list.block(k)[l];
        bits += pair;
        need(b >= 0);
        need(b < padded);
        if (pair) {
          need(a < list.particles());
          need(b < list.particles());
          need(a != b);
        } else if (!list.is_contiguous(s, k)) {
          need(b == a);
        }
      }
    }
  }
  need(slots == list.slots());
  need(bits == list.pairs());
}

// Both searches against the definition, that by cells with all registers that this processor has.
template <int D>
void check_against_brute_force(const Points<D>& p, const std::vector<double>& radii, bool single = false) {
  const Pairs expected = brute_force(p, radii);
  const auto find = [&](taut::SearchMethod method) {
    return single ? taut::find_pairs(p.view(), radii.at(0), {method})
                  : taut::find_pairs(p.view(), std::span<const double>(radii), {method});
  };
  const taut::PairList cells = find(taut::SearchMethod::cell_list), tree = find(taut::SearchMethod::kd_tree);
  check_invariants(cells);
  CHECK(cells.pairs() == static_cast<std::int64_t>(expected.size()));
  CHECK(pairs_of(cells) == expected);
  CHECK(same_layout(cells, tree));
  for (const auto& variant : taut::detail::search_variants<D>()) {
    CAPTURE(variant.simd);
    const taut::detail::Radii given =
        single ? taut::detail::Radii{radii.at(0), {}} : taut::detail::Radii{0, radii};
    CHECK(same_layout(cells, variant.search(p.view(), given)));
  }
  for (const auto& [a, b] : expected) {
    if (!std::binary_search(expected.begin(), expected.end(), std::pair(b, a)))
      FAIL("not symmetric: ", a, " ", b);
  }
}

template <int D>
void check_against_brute_force(const Points<D>& p, double radius) {
  check_against_brute_force(p, std::vector<double>(static_cast<std::size_t>(std::max(p.n(), 1)), radius),
                            true);
}

template <class F>
std::string message_of(F&& f) {
  try {
    f();
  } catch (const taut::InputError& e) {
    return e.what();
  }
  return "(no InputError)";
}

}  // namespace clouds
