#include "cell_grid.hpp"

#include <bit>
#include <cmath>

#include "lanes.hpp"
#include "parallel.hpp"
#include "sort_by_key.hpp"

namespace taut::detail {
namespace {

// Monotone in x, so that points within reach of a box lie in the cells between those of its corners.
inline double cell_of(double x, double size) { return std::floor(std::clamp(x / size, -1e300, 1e300)); }

// Cell numbers are whole numbers of any magnitude; beyond 2^62 they are far apart and only have to differ.
inline std::uint64_t as_bits(double cell) {
  return std::abs(cell) < 0x1p62 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(cell))
                                 : std::bit_cast<std::uint64_t>(cell);
}

typedef std::uint32_t Places __attribute__((vector_size(16)));

inline std::uint64_t mix(std::uint64_t h) {  // finaliser of splitmix64 (Steele, Lea and Flood 2014)
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9;
  h = (h ^ (h >> 27)) * 0x94d049bb133111eb;
  return h ^ (h >> 31);
}

}  // namespace

template <int D>
CellGrid<D>::CellGrid(const PointView<D>& points, const Radii& radii, const Level& level)
    : n_(level.members.empty() ? points.n : static_cast<Index>(level.members.size())),
      graded_(radii.graded()),
      radius_(level.radius) {
  if (n_ == 0) return;
  const Index* members = level.members.empty() ? nullptr : level.members.data();
  const auto particle = [members](std::int64_t i) { return members ? members[i] : static_cast<Index>(i); };

  double cells = 1;
  for (int d = 0; d < D; ++d) {
    size_[d] = d == 0 ? radius_ / 2 : radius_;
    double low = std::numeric_limits<double>::infinity(), high = -low;
#pragma omp parallel for schedule(static) reduction(min                  \
                                                    : low) reduction(max \
                                                                     : high) if (detail::worth_threads(n_))
    for (Index i = 0; i < n_; ++i) {
      const double x = points.x[d][particle(i)];
      low = std::min(low, x);
      high = std::max(high, x);
    }
    low_[d] = cell_of(low, size_[d]);
    high_[d] = cell_of(high, size_[d]);
    extent_[d] = high_[d] - low_[d] + 1;
    cells *= extent_[d];
  }
  dense_ = cells <= 4.0 * n_ + 64;
  buckets_ = dense_ ? static_cast<std::uint64_t>(cells) : std::bit_ceil(2 * static_cast<std::uint64_t>(n_));

  auto keys = std::make_unique_for_overwrite<std::uint32_t[]>(static_cast<std::size_t>(n_));
#pragma omp parallel for schedule(static) if (detail::worth_threads(n_))
  for (Index i = 0; i < n_; ++i) {
    double cell[3] = {};
    for (int d = 0; d < D; ++d) cell[d] = cell_of(points.x[d][particle(i)], size_[d]);
    const std::uint64_t x = dense_ ? static_cast<std::uint64_t>(cell[0] - low_[0]) : as_bits(cell[0]);
    const std::uint64_t key = row(cell[1], cell[2]) + x;
    keys[i] = static_cast<std::uint32_t>(dense_ ? key : key & (buckets_ - 1));
  }
  const auto order =
      sort_by_key(std::span(keys.get(), static_cast<std::size_t>(n_)), std::bit_width(buckets_ - 1));

  const auto size = static_cast<std::size_t>(n_) + lanes;
  for (int d = 0; d < D; ++d) x_[d] = AlignedArray<double>(size);
  if (graded_) r2_ = AlignedArray<double>(size);
  id_ = AlignedArray<Index>(size);
  start_ = AlignedArray<std::uint32_t>(buckets_ + 1);
#pragma omp parallel for schedule(static) if (detail::worth_threads(n_))
  for (Index i = 0; i < n_; ++i) {
    const Index p = particle(order[i]);
    for (int d = 0; d < D; ++d) x_[d][i] = points.x[d][p];
    if (graded_) r2_[i] = radii(p) * radii(p);
    id_[i] = p;
    for (std::uint64_t k = i == 0 ? 0 : keys[i - 1] + std::uint64_t{1}; k <= keys[i]; ++k)
      start_[k] = static_cast<std::uint32_t>(i);
  }
  for (std::uint64_t k = n_ ? keys[n_ - 1] + std::uint64_t{1} : 0; k <= buckets_; ++k)
    start_[k] = static_cast<std::uint32_t>(n_);
  for (int d = 0; d < D; ++d)
    std::fill(x_[d].end() - lanes, x_[d].end(), std::numeric_limits<double>::quiet_NaN());
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
double CellGrid<D>::least_pairs() const {
  if (!dense_ || n_ == 0) return 0;
  // Points in one part of 1/2^(D-1) of a cell are less than a radius apart: its sides are half a radius long.
  constexpr double parts = 1 << (D - 1);
  double pairs = 0;
  for (std::uint64_t k = 0; k < buckets_; ++k) {
    const double count = start_[k + 1] - start_[k];
    if (count > parts) pairs += count * (count / parts - 1);
  }
  return pairs;
}

template <int D>
void CellGrid<D>::collect(const Slice<D>& slice, Workspace& work, LaneMasks& masks) const {
  if (n_ == 0) return;
  if (graded_)
    collect_lanes<true>(slice, 0, slice.count, work, masks);
  else
    collect_lanes<false>(slice, 0, slice.count, work, masks);
}

// One search for all lanes is best while they are near each other. Else the lanes are halved; candidates are
// always tested against all eight, so that a candidate found twice gets the same mask.
template <int D>
template <bool graded>
void CellGrid<D>::collect_lanes(const Slice<D>& slice, int begin, int end, Workspace& work,
                                LaneMasks& masks) const {
  const auto bound = [&](int from, int to, Box& box, double& reach) {
    reach = radius_;
    if constexpr (graded)
      for (int l = from; l < to; ++l) reach = std::max(reach, slice.radius[l]);
    double volume = 1;
    for (int d = 0; d < D; ++d) {
      box.low[d] = *std::min_element(slice.x[d] + from, slice.x[d] + to);
      box.high[d] = *std::max_element(slice.x[d] + from, slice.x[d] + to);
      volume *= 1 + (box.high[d] - box.low[d]) / (2 * reach);
    }
    return volume;  // of the search, in that of one lane alone
  };
  Box box;
  double reach;
  const double volume = bound(begin, end, box, reach);
  if (end - begin > 1 && !(volume < 2)) {
    const int middle = (begin + end) / 2;
    Box half;
    double half_reach;
    const double left = bound(begin, middle, half, half_reach), right = bound(middle, end, half, half_reach);
    if (!(volume <= std::min<double>(left + right, end - begin))) {
      collect_lanes<graded>(slice, begin, middle, work, masks);
      collect_lanes<graded>(slice, middle, end, work, masks);
      return;
    }
  }
  find_runs(box, reach, work.runs);
  test_candidates<graded>(slice, filter<graded>(box, reach, work), work, masks);
}

// The runs of sorted points that lie in cells within reach of the box. Runs may overlap.
template <int D>
void CellGrid<D>::find_runs(const Box& box, double reach, std::vector<Run>& runs) const {
  runs.clear();
  double low[3] = {}, high[3] = {};
  double rows = 1;
  for (int d = 0; d < D; ++d) {
    low[d] = std::max(cell_of(box.low[d] - reach, size_[d]), low_[d]);
    high[d] = std::min(cell_of(box.high[d] + reach, size_[d]), high_[d]);
    if (!(low[d] <= high[d])) return;
    if (d > 0) rows *= high[d] - low[d] + 1;
  }
  const double along = high[0] - low[0] + 1;
  const bool more_cells_than_points =
      rows > n_ / 4 + 16 || (!dense_ && along >= static_cast<double>(buckets_));
  if (more_cells_than_points) {
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

// Candidates: the points nearer to the box than the radius. The distance to the box is rounded as the
// distance to a point is, hence never larger than the distance to a point of the box. Returns their number.
template <int D>
template <bool graded>
std::size_t CellGrid<D>::filter(const Box& box, double reach, Workspace& work) const {
  std::size_t most = 2 * lanes;
  for (const Run& run : work.runs) most += run.end - run.begin + lanes;
  if (work.candidates.size() < most) work.candidates.resize(2 * most);

  Double8 box_low[D], box_high[D];
  const double* sorted[D];
  for (int d = 0; d < D; ++d) {
    box_low[d] = splat8(box.low[d]);
    box_high[d] = splat8(box.high[d]);
    sorted[d] = x_[d].data();
  }
  const double* const sorted_r2 = r2_.data();
  const Double8 reach2 = splat8(reach * reach), zero = splat8(0);
  std::uint32_t* out = work.candidates.data();
  for (const Run& run : work.runs)
    for (std::uint32_t j = run.begin; j < run.end;
         j += lanes) {  // a pack may reach beyond: into points like any others
      Double8 d2;
      for (int d = 0; d < D; ++d) {
        const Double8 x = load8(sorted[d] + j);
        const Double8 gap = max(zero, max(box_low[d] - x, x - box_high[d]));  // in this order NaN stays NaN
        d2 = d == 0 ? gap * gap : d2 + gap * gap;
      }
      const unsigned near = graded ? less(d2, max(reach2, load8(sorted_r2 + j))) : less(d2, reach2);
      const std::uint32_t* const places = mask_tables.places[near].data();
      for (int i = 0; i < lanes; i += 4) {
        const Places four = load_part<Places>(places + i) + j;
        std::memcpy(out + i, &four, sizeof four);
      }
      out += mask_tables.count[near];
    }
  return static_cast<std::size_t>(out - work.candidates.data());
}

template <int D>
template <bool graded>
void CellGrid<D>::test_candidates(const Slice<D>& slice, std::size_t count, Workspace& work,
                                  LaneMasks& masks) const {
  if (work.hits.size() < count + 1) work.hits.resize(2 * count + 1);
  Double8 x[D];
  for (int d = 0; d < D; ++d) x[d] = load8(slice.x[d]);
  const Double8 own_r2 = load8(slice.r2), tiny = splat8(coincident2);
  Double8 r2 = own_r2, same = own_r2 * tiny;
  // In registers: the bytes that the loop stores could else be these.
  const double* sorted[D];
  for (int d = 0; d < D; ++d) sorted[d] = x_[d].data();
  const double* const sorted_r2 = r2_.data();
  const Index* const id = id_.data();
  const std::uint32_t* const candidates = work.candidates.data();
  Index* const hits = work.hits.data();
  std::uint8_t* const lane_masks = &masks[0];
  const Index first = slice.first;
  unsigned coincident_lanes = 0;
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t j = candidates[i];
    Double8 d2;
    for (int d = 0; d < D; ++d) {
      const Double8 dx = x[d] - splat8(sorted[d][j]);
      d2 = d == 0 ? dx * dx : d2 + dx * dx;
    }
    if constexpr (graded) {
      const Double8 other_r2 = splat8(sorted_r2[j]);
      r2 = max(own_r2, other_r2);
      same = min(own_r2, other_r2) * tiny;
    }
    const Index b = id[j];
    const auto lane = static_cast<std::uint32_t>(b - first);
    const unsigned self = lane < lanes ? 1u << lane : 0u;
    const unsigned mask = less(d2, r2) & ~self;
    coincident_lanes |= ~less(same, d2) & mask;
    lane_masks[b] = static_cast<std::uint8_t>(mask);
    hits[found] = b;
    found += mask != 0;
  }
  work.coincident |= coincident_lanes;
  masks.mark(hits, found);
}

template class CellGrid<1>;
template class CellGrid<2>;
template class CellGrid<3>;

}  // namespace taut::detail
