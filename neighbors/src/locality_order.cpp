#include <fmt/format.h>
#include <omp.h>

#include <bit>
#include <cmath>
#include <numeric>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/point_check.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/neighbors/sort_by_key.hpp>
#include <unordered_set>

namespace taut {
namespace {

using Keys = std::vector<std::uint64_t>;

double bin_of(double x, double width) { return std::floor(std::clamp(x / width, -1e300, 1e300)); }

// The occupied bins of one coordinate, ascending.
std::vector<double> occupied_bins(const double* x, Index n, double width) {
  const auto parts = worth_threads(n) ? static_cast<std::size_t>(omp_get_max_threads()) : 1;
  std::vector<std::unordered_set<double>> sets(parts);
  parallel_for(parts, parts > 1, [&](std::size_t part) {
    const std::size_t points = static_cast<std::size_t>(n), last = points * (part + 1) / parts;
    for (std::size_t i = points * part / parts; i < last; ++i) sets[part].insert(bin_of(x[i], width));
  });
  std::vector<double> bins;
  for (const auto& set : sets) bins.insert(bins.end(), set.begin(), set.end());
  std::sort(bins.begin(), bins.end());
  bins.erase(std::unique(bins.begin(), bins.end()), bins.end());
  return bins;
}

// Small whole numbers for the bins of one coordinate, in their order.
struct Ranks {
  std::vector<double> bins;
  std::vector<std::uint64_t> rank;
  double width;

  std::uint64_t operator()(double x) const {
    const double bin = bin_of(x, width);
    return rank[static_cast<std::size_t>(std::lower_bound(bins.begin(), bins.end(), bin) - bins.begin())];
  }
};

// Cells by number, gaps between them closed but for one, so that an outlier does not use up the range.
Ranks rank_cells(const double* x, Index n, double width) {
  Ranks r{occupied_bins(x, n, width), {}, width};
  r.rank.resize(r.bins.size());
  for (std::size_t i = 1; i < r.bins.size(); ++i)
    r.rank[i] = r.rank[i - 1] + (r.bins[i] - r.bins[i - 1] > 1 ? 2 : 1);
  return r;
}

// Planes of a lattice along one coordinate, where it is one: bands of values, narrower than their distance,
// empty space between them. Jitter of less than half a spacing leaves such bands. Empty where there are none.
Ranks rank_planes(const double* x, Index n, double cell) {
  constexpr double bins_a_cell = 64, closed_gap = 4, least_spacing = 0.15 * bins_a_cell, most_width = 0.95;
  Ranks r{occupied_bins(x, n, cell / bins_a_cell), {}, cell / bins_a_cell};
  r.rank.resize(r.bins.size());
  std::vector<double> spacings;
  double begin = r.bins[0], widest = 1;
  for (std::size_t i = 1; i < r.bins.size(); ++i) {
    const bool same = r.bins[i] - r.bins[i - 1] <= closed_gap;  // chance leaves bins of a band empty
    r.rank[i] = r.rank[i - 1] + !same;
    if (!same) {
      spacings.push_back(r.bins[i] - begin);
      begin = r.bins[i];
    }
    widest = std::max(widest, r.bins[i] - begin + 1);
  }
  double spacing = bins_a_cell;
  if (!spacings.empty()) {
    const auto median = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
    std::nth_element(spacings.begin(), median, spacings.end());
    spacing = *median;
  }
  if (spacing < least_spacing || widest > most_width * std::min(spacing, bins_a_cell)) r.bins.clear();
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

// Rows that a block of a plane holds, for rows of n points: pair loops go back and forth over as many planes
// as the support spans, five of nine numbers a point, and those should stay in half a megabyte of cache. All
// rows where that is so anyway.
std::uint64_t rows_a_block(double row_length, std::uint64_t rows) {
  constexpr double points = 1400;
  constexpr std::uint64_t least = 4;  // a block has two borders, whose neighbours are far
  const auto block = std::max(least, static_cast<std::uint64_t>(points / row_length));
  return rows <= block + block / 2 ? rows : (rows + rows / block - 1) / (rows / block);
}

// Rows along the first coordinate, the last coordinate slowest; in 3D large planes are cut into blocks of
// rows, block slowest. Empty where the points do not lie in rows.
template <int D>
Keys row_keys(const PointView<D>& points, double cell) {
  std::array<Ranks, D> planes;
  double rows = 1;
  for (int d = 1; d < D; ++d) {
    planes[d] = rank_planes(points.x[d], points.n, cell);
    if (planes[d].bins.empty()) return {};
    rows *= static_cast<double>(planes[d].rank.back() + 1);
  }
  if (rows > 8.0 * points.n) return {};  // such as a diagonal line
  std::uint64_t block = 1;
  if constexpr (D == 3) block = rows_a_block(static_cast<double>(points.n) / rows, planes[1].rank.back() + 1);
  Keys keys(static_cast<std::size_t>(points.n));
#pragma omp parallel for schedule(static) if (worth_threads(points.n))
  for (Index i = 0; i < points.n; ++i) {
    std::uint64_t key = 0;
    if constexpr (D == 2) key = planes[1](points.x[1][i]);
    if constexpr (D == 3) {
      const std::uint64_t row = planes[1](points.x[1][i]);
      key = (row / block * (planes[2].rank.back() + 1) + planes[2](points.x[2][i])) * block + row % block;
    }
    keys[static_cast<std::size_t>(i)] = key;
  }
  return keys;
}

// Keys of points, sorted later, and the lowest bits of them that tell apart points of one row or cell.
struct SortKeys {
  Keys keys;
  int within;
};

// Where spacings differ, a cell that suits the widest holds hundreds of the narrowest: keys follow the curve
// through cells this many times halved, and only crowded cells use those digits.
constexpr int halvings = 4;
constexpr Index crowd = 8;

template <int D>
SortKeys curve_keys(const PointView<D>& points, double cell) {
  constexpr double parts = 1 << halvings;
  std::array<Ranks, D> cells;
  int bits = 1;
  for (int d = 0; d < D; ++d) {
    cells[d] = rank_cells(points.x[d], points.n, cell);
    bits = std::max(bits, static_cast<int>(std::bit_width(cells[d].rank.back())) + halvings);
  }
  const int shift = std::max(0, bits - 63 / D);
  Keys keys(static_cast<std::size_t>(points.n));
#pragma omp parallel for schedule(static) if (worth_threads(points.n))
  for (Index i = 0; i < points.n; ++i) {
    std::array<std::uint64_t, D> c;
    for (int d = 0; d < D; ++d) {
      const double x = points.x[d][i] / cell;
      const double part = std::min((x - std::floor(x)) * parts, parts - 1);  // 0 where x is beyond 2^53
      c[d] = (cells[d](points.x[d][i]) << halvings | static_cast<std::uint64_t>(part)) >> shift;
    }
    keys[static_cast<std::size_t>(i)] = hilbert<D>(c, bits - shift);
  }
  return {std::move(keys), D * std::max(0, halvings - shift)};
}

// Sorts the points of each row, or cell: in rows the first coordinate decides, in cells the last. A crowded
// cell falls into those of the next digit of its keys, as long as `within` leaves one.
template <int D>
void sort_within(const PointView<D>& points, const Keys& sorted, int within, bool rows,
                 std::vector<Index>& order) {
  const auto before = [&](Index a, Index b) {
    for (int i = 0; i < D; ++i) {
      const double* x = points.x[rows ? i : D - 1 - i];
      if (x[a] != x[b]) return x[a] < x[b];
    }
    return a < b;
  };
  const auto same = [&](Index i, Index j, int shift) {
    return sorted[static_cast<std::size_t>(i)] >> shift == sorted[static_cast<std::size_t>(j)] >> shift;
  };
  const auto sort_cell = [&](auto&& self, Index begin, Index end, int shift) -> void {
    if (shift == 0 || end - begin <= crowd) {
      std::sort(order.begin() + begin, order.begin() + end, before);
      return;
    }
    shift -= D;
    for (Index i = begin; i < end;) {
      const Index from = i++;
      while (i < end && same(i, from, shift)) ++i;
      self(self, from, i, shift);
    }
  };
#pragma omp parallel for schedule(dynamic, 4096) if (worth_threads(points.n))
  for (Index i = 0; i < points.n; ++i) {
    if (i > 0 && same(i, i - 1, within)) continue;
    Index end = i + 1;
    while (end < points.n && same(end, i, within)) ++end;
    sort_cell(sort_cell, i, end, within);
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

  SortKeys by{row_keys(points, cell), 0};
  const bool rows = !by.keys.empty();
  if (!rows) by = curve_keys(points, cell);
  const auto largest = *std::max_element(by.keys.begin(), by.keys.end());
  const auto from = detail::sort_by_key(std::span(by.keys), std::bit_width(largest));
  std::copy_n(from.get(), order.size(), order.begin());
  sort_within(points, by.keys, by.within, rows, order);
  return order;
}

template std::vector<Index> locality_order(PointView<1>, double);
template std::vector<Index> locality_order(PointView<2>, double);
template std::vector<Index> locality_order(PointView<3>, double);

}  // namespace taut
