#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/cell_grid.hpp>
#include <taut/neighbors/lanes.hpp>
#include <taut/neighbors/sort_by_key.hpp>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {
namespace {

// Monotone in x, so that points within reach of a box lie in the cells between those of its corners.
inline double cell_of(double x, double size) { return std::floor(std::clamp(x / size, -1e300, 1e300)); }

// Cell numbers are whole numbers of any magnitude; beyond 2^62 they are far apart and only have to differ.
inline std::uint64_t as_bits(double cell) {
  return std::abs(cell) < 0x1p62 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(cell))
                                 : std::bit_cast<std::uint64_t>(cell);
}

inline std::uint64_t mix(std::uint64_t h) {  // finaliser of splitmix64 (Steele, Lea and Flood 2014)
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9;
  h = (h ^ (h >> 27)) * 0x94d049bb133111eb;
  return h ^ (h >> 31);
}

// Bounds of a number in single precision, finite ones; the number itself may be off by a few units in its
// last place.
constexpr float most = std::numeric_limits<float>::max() / 2;
inline float lower_bound(double v) {
  const auto f = static_cast<float>(std::clamp<double>(v, -most, most));
  return f - std::abs(f) * 0x1p-22f;
}
inline float upper_bound(double v) { return -lower_bound(-v); }

// Squared distances of bounds, in units of the largest radius, are too large by less.
constexpr double rounding = 1 + 1e-6;

}  // namespace

template <int D>
CellGrid<D>::CellGrid(const Clusters<D>& clusters, std::span<const Index> members, bool graded)
    : n_(members.empty() ? clusters.slices() : static_cast<Index>(members.size())), graded_(graded) {
  if (n_ == 0) return;
  const auto cluster = [&](Index i) -> const Cluster<D>& {
    return clusters[members.empty() ? i : members[static_cast<std::size_t>(i)]];
  };

  double radius = 0, first[D], last[D], longest[D] = {};
  const Cluster<D>& any = cluster(0);
  for (int d = 0; d < D; ++d) first[d] = last[d] = any.box.low[d];
#pragma omp parallel for reduction(max : radius, last, longest) reduction(min : first) if (worth_threads(n_))
  for (Index i = 0; i < n_; ++i) {
    const Cluster<D>& c = cluster(i);
    radius = std::max(radius, c.radius);
    for (int d = 0; d < D; ++d) {
      first[d] = std::min(first[d], c.box.low[d]);
      last[d] = std::max(last[d], c.box.low[d]);
      longest[d] = std::max(longest[d], c.box.high[d] - c.box.low[d]);
    }
  }
  radius_ = radius;
  double cells = 1;
  for (int d = 0; d < D; ++d) {
    longest_[d] = std::nextafter(longest[d], std::numeric_limits<double>::infinity());  // it was rounded
    low_[d] = cell_of(first[d], radius_);
    high_[d] = cell_of(last[d], radius_);
    corner_[d] = first[d];
    extent_[d] = high_[d] - low_[d] + 1;
    cells *= extent_[d];
  }
  dense_ = cells <= 4.0 * n_ + 64;
  buckets_ = dense_ ? static_cast<std::uint64_t>(cells) : std::bit_ceil(2 * static_cast<std::uint64_t>(n_));

  auto keys = std::make_unique_for_overwrite<std::uint32_t[]>(static_cast<std::size_t>(n_));
#pragma omp parallel for schedule(static) if (worth_threads(n_))
  for (Index i = 0; i < n_; ++i) {
    const Cluster<D>& c = cluster(i);
    double cell[3] = {};
    for (int d = 0; d < D; ++d) cell[d] = cell_of(c.box.low[d], radius_);
    const std::uint64_t x = dense_ ? static_cast<std::uint64_t>(cell[0] - low_[0]) : as_bits(cell[0]);
    const std::uint64_t key = row(cell[1], cell[2]) + x;
    keys[i] = static_cast<std::uint32_t>(dense_ ? key : key & (buckets_ - 1));
  }
  const auto order =
      sort_by_key(std::span(keys.get(), static_cast<std::size_t>(n_)), std::bit_width(buckets_ - 1));

  const auto size = static_cast<std::size_t>(n_) + floats;
  for (int d = 0; d < D; ++d) {
    lows_[d] = AlignedArray<float>::for_overwrite(size);
    highs_[d] = AlignedArray<float>::for_overwrite(size);
  }
  if (graded_) r2_ = AlignedArray<float>::for_overwrite(size);
  slice_ = AlignedArray<Index>::for_overwrite(size);
  auto inside = std::make_unique_for_overwrite<std::uint8_t[]>(static_cast<std::size_t>(n_));
  start_ = AlignedArray<std::uint32_t>::for_overwrite(buckets_ + 1);
#pragma omp parallel for schedule(static) if (worth_threads(n_))
  for (Index i = 0; i < n_; ++i) {
    const Cluster<D>& c = cluster(order[i]);
    bool in_cell = true;
    for (int d = 0; d < D; ++d) {
      lows_[d][i] = lower_bound((c.box.low[d] - corner_[d]) / radius_);
      highs_[d][i] = upper_bound((c.box.high[d] - corner_[d]) / radius_);
      in_cell = in_cell && cell_of(c.box.low[d], radius_) == cell_of(c.box.high[d], radius_);
    }
    if (graded_) r2_[i] = upper_bound(c.radius / radius_ * (c.radius / radius_) * rounding);
    slice_[i] = c.slice;
    inside[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(in_cell ? c.count : 0);
    for (std::uint64_t k = i == 0 ? 0 : keys[i - 1] + std::uint64_t{1}; k <= keys[i]; ++k)
      start_[k] = static_cast<std::uint32_t>(i);
  }
  for (std::uint64_t k = keys[n_ - 1] + std::uint64_t{1}; k <= buckets_; ++k)
    start_[k] = static_cast<std::uint32_t>(n_);
  if (dense_) least_pairs_ = count_least_pairs(inside.get());
}

// Bucket of the cell of a row whose x is zero (hashed) or the lowest (dense).
template <int D>
std::uint64_t CellGrid<D>::row(double y, double z) const {
  if constexpr (D == 1) return 0;
  if (dense_) {
    double r = y - low_[1];
    if constexpr (D == 3) r += (z - low_[2]) * extent_[1];
    return static_cast<std::uint64_t>(r * extent_[0]);
  }
  std::uint64_t h = mix(as_bits(y));
  if constexpr (D == 3) h = mix(h ^ as_bits(z));
  return h;
}

template <int D>
std::size_t CellGrid<D>::find(const Box<D>& box, double reach, Workspace& work) const {
  if (n_ == 0) return 0;
  reach = std::max(reach, radius_);
  find_runs(box, reach, work.runs);
  return graded_ ? filter<true>(box, reach, work) : filter<false>(box, reach, work);
}

// The runs of sorted clusters that lie in cells within reach of the box. Runs may overlap.
template <int D>
void CellGrid<D>::find_runs(const Box<D>& box, double reach, std::vector<Run>& runs) const {
  runs.clear();
  double low[3] = {}, high[3] = {};
  double rows = 1;
  for (int d = 0; d < D; ++d) {
    low[d] = std::max(cell_of(box.low[d] - reach - longest_[d], radius_), low_[d]);
    high[d] = std::min(cell_of(box.high[d] + reach, radius_), high_[d]);
    if (!(low[d] <= high[d])) return;
    if (d > 0) rows *= high[d] - low[d] + 1;
  }
  const double along = high[0] - low[0] + 1;
  const bool more_cells_than_clusters =
      rows > n_ / 4 + 16 || (!dense_ && along >= static_cast<double>(buckets_));
  if (more_cells_than_clusters) {
    runs.push_back({0, static_cast<std::uint32_t>(n_)});
    return;
  }
  const std::uint32_t* const start = start_.data();
  const auto put = [&](std::uint64_t from, std::uint64_t to) {
    if (start[from] != start[to]) runs.push_back({start[from], start[to]});
  };
  const auto nx = static_cast<std::uint64_t>(along), ny = static_cast<std::uint64_t>(high[1] - low[1]) + 1,
             nz = static_cast<std::uint64_t>(high[2] - low[2]) + 1;
  if (dense_) {
    const auto stride_y = static_cast<std::uint64_t>(extent_[0]);
    const auto stride_z = D == 3 ? static_cast<std::uint64_t>(extent_[0] * extent_[1]) : 0;
    const std::uint64_t first = row(low[1], low[2]) + static_cast<std::uint64_t>(low[0] - low_[0]);
    for (std::uint64_t z = 0; z < nz; ++z)
      for (std::uint64_t y = 0; y < ny; ++y) {
        const std::uint64_t from = first + z * stride_z + y * stride_y;
        put(from, from + nx);
      }
    return;
  }
  for (std::uint64_t z = 0; z < nz; ++z)
    for (std::uint64_t y = 0; y < ny; ++y) {
      const std::uint64_t base = row(low[1] + static_cast<double>(y), low[2] + static_cast<double>(z));
      const std::uint64_t from = (base + as_bits(low[0])) & (buckets_ - 1), to = from + nx;
      put(from, std::min(to, buckets_));
      if (to > buckets_) put(0, to - buckets_);
    }
}

// Clusters nearer to the box than the radius.
template <int D>
template <bool graded>
std::size_t CellGrid<D>::filter(const Box<D>& box, double reach, Workspace& work) const {
  std::size_t room = floats;
  for (const Run& run : work.runs) room += run.end - run.begin + floats;
  if (work.slices.size() < room) work.slices.resize(2 * room);

  Float16 box_low[D], box_high[D];
  const float *lows[D], *highs[D];
  for (int d = 0; d < D; ++d) {
    box_low[d] = splat16(lower_bound((box.low[d] - corner_[d]) / radius_));
    box_high[d] = splat16(upper_bound((box.high[d] - corner_[d]) / radius_));
    lows[d] = lows_[d].data();
    highs[d] = highs_[d].data();
  }
  const float* const r2 = r2_.data();
  const Index* const slice = slice_.data();
  const auto n = static_cast<std::uint32_t>(n_);
  // Where squares overflow nothing but everything can be near.
  const Float16 reach2 = splat16(upper_bound(reach / radius_ * (reach / radius_) * rounding)),
                zero = splat16(0), largest = splat16(most / 2);
  Index* out = work.slices.data();
  for (const Run& run : work.runs)
    for (std::uint32_t j = run.begin; j < run.end;
         j += floats) {  // a pack may reach beyond: into clusters like any others
      Float16 d2;
      for (int d = 0; d < D; ++d) {
        const Float16 below = box_low[d] - load16(highs[d] + j), above = load16(lows[d] + j) - box_high[d];
        const Float16 gap = max(zero, max(below, above));
        d2 = d == 0 ? gap * gap : multiply_add(gap, gap, d2);
      }
      unsigned near = less(min(d2, largest), graded ? max(reach2, load16(r2 + j)) : reach2);
      if (j + floats > n) near &= (1u << (n - j)) - 1;
      out = store_picked(slice + j, near & 0xff, out);
      out = store_picked(slice + j + lanes, near >> lanes, out);
    }
  return static_cast<std::size_t>(out - work.slices.data());
}

// By the pigeonhole principle: particles in one part of 1/2^D of a cell are less than a radius apart, as its
// sides are half a radius long. `inside`: the number of particles of clusters that lie wholly in their cell.
template <int D>
double CellGrid<D>::count_least_pairs(const std::uint8_t* inside) const {
  constexpr double parts = 1 << D;
  double pairs = 0;
#pragma omp parallel for schedule(static) reduction(+ : pairs) if (worth_threads(n_))
  for (std::uint64_t k = 0; k < buckets_; ++k) {
    if ((start_[k + 1] - start_[k]) * lanes <= parts) continue;
    double count = 0;
    for (std::uint32_t j = start_[k]; j < start_[k + 1]; ++j) count += inside[j];
    if (count > parts) pairs += count * (count / parts - 1);
  }
  return pairs;
}

template class CellGrid<1>;
template class CellGrid<2>;
template class CellGrid<3>;

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
