#include <fmt/format.h>
#include <omp.h>

#include <bit>
#include <cmath>
#include <numeric>
#include <taut/core/error.hpp>
#include <taut/neighbors/search.hpp>
#include <unordered_set>

#include "parallel.hpp"
#include "point_check.hpp"
#include "sort_by_key.hpp"

namespace taut {
namespace {

using Keys = std::vector<std::uint64_t>;

double bin_of(double x, double width) { return std::floor(std::clamp(x / width, -1e300, 1e300)); }

// The occupied bins of one coordinate, ascending; empty where there are more than `limit`.
std::vector<double> occupied_bins(const double* x, Index n, double width, std::size_t limit) {
  std::vector<std::unordered_set<double>> sets(static_cast<std::size_t>(omp_get_max_threads()));
#pragma omp parallel if (detail::worth_threads(n))
  {
    std::unordered_set<double>& set = sets[static_cast<std::size_t>(omp_get_thread_num())];
#pragma omp for schedule(static)
    for (Index i = 0; i < n; ++i)
      if (set.size() <= limit) set.insert(bin_of(x[i], width));
  }
  std::vector<double> bins;
  for (const auto& set : sets) bins.insert(bins.end(), set.begin(), set.end());
  std::sort(bins.begin(), bins.end());
  bins.erase(std::unique(bins.begin(), bins.end()), bins.end());
  if (bins.size() > limit) bins.clear();
  return bins;
}

// Small whole numbers for the bins of one coordinate, in their order. Gaps are cut down to `gap`, so that an
// outlier does not use up the range.
struct Ranks {
  std::vector<double> bins;
  std::vector<std::uint64_t> rank;
  double width;

  std::uint64_t operator()(double x) const {
    const double bin = bin_of(x, width);
    return rank[static_cast<std::size_t>(std::lower_bound(bins.begin(), bins.end(), bin) - bins.begin())];
  }
};

Ranks rank_cells(const double* x, Index n, double width) {
  Ranks r{occupied_bins(x, n, width, static_cast<std::size_t>(n)), {}, width};
  r.rank.resize(r.bins.size());
  for (std::size_t i = 1; i < r.bins.size(); ++i)
    r.rank[i] = r.rank[i - 1] + (r.bins[i] - r.bins[i - 1] > 1 ? 2 : 1);
  return r;
}

// Numbers of the planes of a lattice along one coordinate, where it is one: values that differ by rounding
// only, and planes whose distances are no small fraction of a cell. Empty where it is not.
Ranks rank_planes(const double* x, Index n, double cell) {
  constexpr double rounding = 1e-6, near = 0.05;  // over the cell size
  const auto [low, high] = std::minmax_element(x, x + n);
  const double most = 64 + 20 * ((*high - *low) / cell);
  const double width = rounding * cell;
  Ranks r{occupied_bins(x, n, width, static_cast<std::size_t>(std::min<double>(most, n))), {}, width};
  r.rank.resize(r.bins.size());
  std::size_t too_near = 0;
  for (std::size_t i = 1; i < r.bins.size(); ++i) {
    const double gap = r.bins[i] - r.bins[i - 1];
    // A plane may straddle the border of two bins, but not more.
    const bool same = gap <= 1 && (i < 2 || r.rank[i - 1] > r.rank[i - 2]);
    r.rank[i] = r.rank[i - 1] + !same;
    too_near += !same && gap * rounding < near;
  }
  if (!r.bins.empty() && static_cast<double>(too_near) > 0.05 * static_cast<double>(r.rank.back()))
    r.bins.clear();
  return r;
}

// Position along the Hilbert curve (Skilling, AIP Conf. Proc. 707, 2004) of a cell with coordinates of `bits`
// bits.
template <int D>
std::uint64_t hilbert(std::array<std::uint64_t, D> c, int bits) {
  const std::uint64_t top = std::uint64_t{1} << (bits - 1);
  for (std::uint64_t q = top; q > 1; q >>= 1)
    for (auto& ci : c) {
      if (ci & q) {
        c[0] ^= q - 1;
      } else {
        const std::uint64_t t = (c[0] ^ ci) & (q - 1);
        c[0] ^= t;
        ci ^= t;
      }
    }
  for (std::size_t d = 1; d < D; ++d) c[d] ^= c[d - 1];
  std::uint64_t t = 0;
  for (std::uint64_t q = top; q > 1; q >>= 1)
    if (c[D - 1] & q) t ^= q - 1;
  std::uint64_t key = 0;
  for (int b = bits - 1; b >= 0; --b)
    for (std::size_t d = 0; d < D; ++d) key = key << 1 | ((c[d] ^ t) >> b & 1);
  return key;
}

// Empty where the points are no lattice.
template <int D>
Keys lattice_keys(const PointView<D>& points, double cell) {
  std::array<Ranks, D> planes;
  double product = 1;
  for (int d = 0; d < D; ++d) {
    planes[d] = rank_planes(points.x[d], points.n, cell);
    if (planes[d].bins.empty()) return {};
    product *= static_cast<double>(planes[d].rank.back() + 1);
    if (product > 64.0 * points.n) return {};
  }
  Keys keys(static_cast<std::size_t>(points.n));
#pragma omp parallel for schedule(static) if (detail::worth_threads(points.n))
  for (Index i = 0; i < points.n; ++i) {
    std::uint64_t key = 0;
    for (int d = D - 1; d >= 0; --d) key = key * (planes[d].rank.back() + 1) + planes[d](points.x[d][i]);
    keys[static_cast<std::size_t>(i)] = key;
  }
  return keys;
}

template <int D>
Keys curve_keys(const PointView<D>& points, double cell) {
  std::array<Ranks, D> cells;
  int bits = 1;
  for (int d = 0; d < D; ++d) {
    cells[d] = rank_cells(points.x[d], points.n, cell);
    bits = std::max(bits, static_cast<int>(std::bit_width(cells[d].rank.back())));
  }
  const int shift = std::max(0, bits - 63 / D);
  Keys keys(static_cast<std::size_t>(points.n));
#pragma omp parallel for schedule(static) if (detail::worth_threads(points.n))
  for (Index i = 0; i < points.n; ++i) {
    std::array<std::uint64_t, D> c;
    for (int d = 0; d < D; ++d) c[d] = cells[d](points.x[d][i]) >> shift;
    keys[static_cast<std::size_t>(i)] = hilbert<D>(c, bits - shift);
  }
  return keys;
}

// Sorts the points that share a cell, last coordinate slowest.
template <int D>
void sort_within_cells(const PointView<D>& points, const Keys& sorted, std::vector<Index>& order) {
  const auto before = [&](Index a, Index b) {
    for (int d = D - 1; d >= 0; --d)
      if (points.x[d][a] != points.x[d][b]) return points.x[d][a] < points.x[d][b];
    return a < b;
  };
#pragma omp parallel for schedule(dynamic, 4096) if (detail::worth_threads(points.n))
  for (Index i = 0; i < points.n; ++i) {
    const auto at = [&](Index j) { return sorted[static_cast<std::size_t>(j)]; };
    if (i > 0 && at(i) == at(i - 1)) continue;
    Index end = i + 1;
    while (end < points.n && at(end) == at(i)) ++end;
    std::sort(order.begin() + i, order.begin() + end, before);
  }
}

}  // namespace

template <int D>
std::vector<Index> locality_order(PointView<D> points, double cell) {
  detail::check_points(points);
  if (!(cell >= 1e-150 && cell <= 1e150))
    throw InputError(fmt::format("cell {}: the size of a cell is a finite length greater than 0", cell));
  std::vector<Index> order(static_cast<std::size_t>(points.n));
  if (points.n == 0) return order;

  Keys keys;
  bool lattice = true;
  if constexpr (D == 1) {
    keys.assign(order.size(), 0);  // a line has one order: the sort within cells gives it
  } else {
    keys = lattice_keys(points, cell);
    lattice = !keys.empty();
  }
  if (keys.empty()) keys = curve_keys(points, cell);
  const auto largest = *std::max_element(keys.begin(), keys.end());
  const auto from = detail::sort_by_key(std::span(keys), std::bit_width(largest));
  std::copy_n(from.get(), order.size(), order.begin());
  if (D == 1 || !lattice) sort_within_cells(points, keys, order);
  return order;
}

template std::vector<Index> locality_order(PointView<1>, double);
template std::vector<Index> locality_order(PointView<2>, double);
template std::vector<Index> locality_order(PointView<3>, double);

}  // namespace taut
