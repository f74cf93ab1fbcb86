#include "cell_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "lanes.hpp"
#include "parallel.hpp"

namespace taut::detail {
namespace {

// Bits of ascending_.
constexpr std::uint8_t within = 1, onward = 2;

// Clusters by half-octaves of their radii; one empty list, that is all of them, where there is one radius.
// Cells are as wide as the largest radius: whole octaves search a tenth longer, in cells too wide for many.
template <int D>
std::vector<std::vector<Index>> levels_of(const Clusters<D>& clusters, bool graded) {
  if (!graded) return {{}};
  std::map<int, std::vector<Index>> by_radius;
  for (std::size_t c = 0; c < clusters.all.size(); ++c) {
    const auto half_octave = static_cast<int>(std::floor(2 * std::log2(clusters.all[c].radius)));
    by_radius[half_octave].push_back(static_cast<Index>(c));
  }
  std::vector<std::vector<Index>> result;
  for (auto& [half_octave, members] : by_radius) result.push_back(std::move(members));
  return result;
}

typedef std::uint32_t Places __attribute__((vector_size(16)));

// Eight numbers from place 8 - l on are infinite in lane l, those from place 0 on nowhere: added to distances
// from particle l of the slice, or from one of no slice, they part it from itself.
constexpr std::array<double, 2 * lanes> itself = [] {
  std::array<double, 2 * lanes> a{};
  a[lanes] = std::numeric_limits<double>::infinity();
  return a;
}();

}  // namespace

template <int D>
CellSearch<D>::CellSearch(const PointView<D>& points, const Radii& radii)
    : points_(points), radii_(radii), clusters_(points, radii) {
  for (const auto& members : levels_of(clusters_, radii.graded()))
    grids_.emplace_back(std::span<const Cluster<D>>(clusters_.all.data(), clusters_.all.size()), members,
                        radii.graded());

  const auto slices = static_cast<Index>(clusters_.begin.size()) - 1;
  ascending_.resize(static_cast<std::size_t>(slices));
#pragma omp parallel for schedule(static) if (worth_threads(points.n))
  for (Index s = 0; s < points.n / lanes; ++s) {
    const double* x = points.x[0] + s * lanes;
    bool ascending = true;
    for (int l = 1; l < lanes; ++l) ascending &= x[l - 1] < x[l];
    const bool on = (s + 1) * lanes < points.n && x[lanes - 1] < x[lanes];
    ascending_[static_cast<std::size_t>(s)] = static_cast<std::uint8_t>(ascending * within + on * onward);
  }
  if (slices == 0) return;
  const Slice<D> last = make_slice(points, radii, slices - 1);
  for (int d = 0; d < D; ++d) std::copy_n(last.x[d], lanes, last_x_[d]);
  std::copy_n(last.radius, lanes, last_radius_);
}

template <int D>
double CellSearch<D>::least_pairs() const {
  double sum = 0;
  for (const CellGrid<D>& grid : grids_) sum += grid.least_pairs();
  return sum;
}

template <int D>
unsigned CellSearch<D>::search(const Slice<D>& slice, Workspace& work, SliceEncoder& encoder) const {
  find_runs(slice, work);
  return radii_.graded() ? test<true>(slice, work, encoder) : test<false>(slice, work, encoder);
}

template <int D>
void CellSearch<D>::find_runs(const Slice<D>& slice, Workspace& work) const {
  const auto s = static_cast<std::size_t>(slice.first / lanes);
  for (Index c = clusters_.begin[s]; c < clusters_.begin[s + 1]; ++c) {
    const Cluster<D>& cluster = clusters_.all[c];
    for (const CellGrid<D>& grid : grids_) {
      const std::size_t count = grid.find(cluster.box, cluster.radius, work.cells);
      work.near.insert(work.cells.slices.data(), count);
    }
  }
  work.runs.clear();
  work.near.drain(0, [&](Index begin, Index end) {
    work.runs.push_back({begin * lanes, std::min(end * lanes, points_.n), ordered(slice, begin, end)});
  });
}

// Whether both the slice and a run of slices ascend along x, so that diagonals of their pairs can be tested.
template <int D>
bool CellSearch<D>::ordered(const Slice<D>& slice, Index begin, Index end) const {
  if (begin == 0 || (end + 1) * lanes > points_.n) return false;  // diagonals would leave the arrays
  if (!(slice.per_length * slice.reach < 1 / coincident)) return false;
  unsigned all = ascending_[static_cast<std::size_t>(slice.first / lanes)] | onward;
  for (Index s = begin; s < end - 1; ++s) all &= ascending_[static_cast<std::size_t>(s)];
  return all == (within | onward) && ascending_[static_cast<std::size_t>(end - 1)] & within;
}

template <int D>
template <bool graded>
unsigned CellSearch<D>::test(const Slice<D>& slice, Workspace& work, SliceEncoder& encoder) const {
  Double8 least = splat8(std::numeric_limits<double>::infinity());  // distance squared
  test_candidates<graded>(slice, filter<graded>(slice, work), work, least);

  constexpr Index closed_gap = 2 * lanes;  // the encoder's chunks would cover it anyway
  for (std::size_t r = 0; r < work.runs.size(); ++r) {
    const Run& run = work.runs[r];
    if (run.ordered) {
      test_diagonals<graded>(slice, run, work, encoder, least);
      continue;
    }
    while (r + 1 < work.runs.size() && !work.runs[r + 1].ordered &&
           work.runs[r + 1].begin - work.runs[r].end <= closed_gap)
      ++r;
    encoder.encode_masks(work.masks.data(), run.begin, work.runs[r].end);
  }
  encoder.end_slice();
  return less(load8(slice.r2) * splat8(coincident2), least) == 0xff ? 0 : coincident_lanes(slice, work);
}

// Candidates: the particles of the runs without order that are nearer to the slice's box than the radius.
// Returns their number.
template <int D>
template <bool graded>
std::size_t CellSearch<D>::filter(const Slice<D>& slice, Workspace& work) const {
  std::size_t most = lanes;
  for (const Run& run : work.runs)
    if (!run.ordered) most += static_cast<std::size_t>(run.end - run.begin) + lanes;
  if (work.candidates.size() < most) work.candidates.resize(2 * most);

  Double8 low[D], high[D];
  const double* other[D];
  for (int d = 0; d < D; ++d) {
    other[d] = points_.x[d];
    low[d] = splat8(*std::min_element(slice.x[d], slice.x[d] + slice.count));
    high[d] = splat8(*std::max_element(slice.x[d], slice.x[d] + slice.count));
  }
  const double* const radii = radii_.each.data();
  const Index n = points_.n;
  const Double8 reach2 = splat8(slice.reach * slice.reach), zero = splat8(0);
  Index* out = work.candidates.data();
  for (const Run& run : work.runs) {
    if (run.ordered) continue;
    for (Index j = run.begin; j < run.end; j += lanes) {
      const bool whole = j + lanes <= n;
      Double8 d2;
      for (int d = 0; d < D; ++d) {
        const Double8 x = load8(whole ? other[d] + j : last_x_[d]);
        const Double8 gap = max(zero, max(low[d] - x, x - high[d]));  // in this order NaN stays NaN
        d2 = d == 0 ? gap * gap : d2 + gap * gap;
      }
      unsigned near;
      if constexpr (graded) {
        const Double8 radius = load8(whole ? radii + j : last_radius_);
        near = less(d2, max(reach2, radius * radius));
      } else {
        near = less(d2, reach2);
      }
      const std::uint32_t* const places = mask_tables.places[near].data();
      for (int i = 0; i < lanes; i += 4) {
        const Places four = load_part<Places>(places + i) + static_cast<std::uint32_t>(j);
        std::memcpy(out + i, &four, sizeof four);
      }
      out += mask_tables.count[near];
    }
  }
  return static_cast<std::size_t>(out - work.candidates.data());
}

template <int D>
template <bool graded>
void CellSearch<D>::test_candidates(const Slice<D>& slice, std::size_t count, Workspace& work,
                                    Double8& least) const {
  Double8 x[D];
  for (int d = 0; d < D; ++d) x[d] = load8(slice.x[d]);
  const Double8 own_r2 = load8(slice.r2);
  // In registers: the bytes that the loop stores could else be these.
  const double* other[D];
  for (int d = 0; d < D; ++d) other[d] = points_.x[d];
  const double* const radius = radii_.each.data();
  const Index* const candidates = work.candidates.data();
  std::uint8_t* const masks = work.masks.data();
  const Index first = slice.first;
  Double8 nearest = least;
  for (std::size_t i = 0; i < count; ++i) {
    const Index b = candidates[i];
    Double8 d2;
    for (int d = 0; d < D; ++d) {
      const Double8 dx = x[d] - splat8(other[d][b]);
      d2 = d == 0 ? dx * dx : d2 + dx * dx;
    }
    Double8 r2 = own_r2;
    if constexpr (graded) r2 = max(own_r2, splat8(radius[b] * radius[b]));
    const std::uint32_t lane = std::min<std::uint32_t>(static_cast<std::uint32_t>(b - first), lanes);
    d2 = d2 + load8(itself.data() + lanes - lane);
    masks[b] = static_cast<std::uint8_t>(less(d2, r2));
    nearest = min(d2, nearest);
  }
  least = nearest;
}

// Tests slots of pairs (slice.first + l, f + l) as a whole, for all f that have pairs of the run. Both ascend
// along x, hence so do the differences of x in a lane with f, rounded as they are: once none is below the
// radius, none will be farther on. Lanes that have not entered the run then are no exception, since they will
// meet its first particle from farther behind than the lane that meets it now.
template <int D>
template <bool graded>
void CellSearch<D>::test_diagonals(const Slice<D>& slice, const Run& run, Workspace& work,
                                   SliceEncoder& encoder, Double8& least) const {
  const Index before = run.begin - lanes, length = run.end - before;
  if (work.diagonals.size() < static_cast<std::size_t>(length))
    work.diagonals.resize(2 * static_cast<std::size_t>(length));
  std::uint8_t* const masks = work.diagonals.data() - before;

  const double* other[D];
  Double8 own[D];
  for (int d = 0; d < D; ++d) {
    other[d] = points_.x[d];
    own[d] = load8(slice.x[d]);
  }
  const double* const radius = radii_.each.data();
  const Double8 own_r2 = load8(slice.r2);
  double reach = slice.reach;
  if constexpr (graded) reach = std::max(reach, *std::max_element(radius + run.begin, radius + run.end));
  const Double8 far = splat8(reach), far_behind = splat8(-reach);
  Double8 nearest = least;

  const auto lanes_inside = [&](Index f) {
    return 0xffu << std::max(run.begin - f, 0) & 0xffu >> std::max(f + lanes - run.end, 0);
  };
  const auto test = [&](Index f, const Double8& dx) {
    Double8 d2 = dx * dx;
    for (int d = 1; d < D; ++d) {
      const Double8 gap = load8(other[d] + f) - own[d];
      d2 = d2 + gap * gap;
    }
    Double8 r2 = own_r2;
    if constexpr (graded) {
      const Double8 r = load8(radius + f);
      r2 = max(own_r2, r * r);
    }
    masks[f] = static_cast<std::uint8_t>(less(d2, r2));
    if (f == slice.first)
      masks[f] = 0;
    else
      nearest = min(d2, nearest);
  };

  // Where the run begins to pass the slice, were both evenly spaced, and for how many slots it is within
  // reach: what is predicted needs no test of its own.
  const double* const row = other[0] + run.begin;
  const double passes = (slice.middle - (row[0] + row[lanes - 1]) / 2) * slice.per_length;
  const auto clip = [&](double f) {
    return static_cast<Index>(std::clamp(f, run.begin - lanes + 1.0, run.end + 0.0));
  };
  const double wide = std::rint(reach * slice.per_length), middle = run.begin + std::rint(passes);
  Index begin = clip(middle - wide), end = clip(middle + wide + 1);
  for (Index f = begin; f < end; ++f) test(f, load8(other[0] + f) - own[0]);
  for (; end < run.end; ++end) {
    const Double8 dx = load8(other[0] + end) - own[0];
    if (!(less(dx, far) & lanes_inside(end))) break;
    test(end, dx);
  }
  for (; begin > run.begin - lanes + 1; --begin) {
    const Double8 dx = load8(other[0] + begin - 1) - own[0];
    if (!(less(far_behind, dx) & lanes_inside(begin - 1))) break;
    test(begin - 1, dx);
  }
  least = nearest;
  encoder.encode_diagonals(masks, begin, end);
}

template <int D>
unsigned CellSearch<D>::coincident_lanes(const Slice<D>& slice, const Workspace& work) const {
  unsigned found = 0;
  for (const Run& run : work.runs)
    for (Index b = run.begin; b < run.end; ++b)
      for (int l = 0; l < slice.count; ++l) {
        if (b == slice.first + l) continue;
        double d2 = 0;
        for (int d = 0; d < D; ++d) {
          const double dx = slice.x[d][l] - points_.x[d][b];
          d2 = d == 0 ? dx * dx : d2 + dx * dx;
        }
        const double r2 = radii_(b) * radii_(b);
        if (d2 <= std::min(slice.r2[l], r2) * coincident2) found |= 1u << l;
      }
  return found;
}

template class CellSearch<1>;
template class CellSearch<2>;
template class CellSearch<3>;

}  // namespace taut::detail
