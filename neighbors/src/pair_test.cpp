#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <taut/neighbors/lanes.hpp>
#include <taut/neighbors/pair_test.hpp>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {
namespace {

// Eight numbers from place 8 - l on are infinite in lane l, those from place 0 on nowhere: added to distances
// from particle l of the slice, or from one of no slice, they part it from itself.
constexpr std::array<double, 2 * lanes> itself = [] {
  std::array<double, 2 * lanes> a{};
  a[lanes] = std::numeric_limits<double>::infinity();
  return a;
}();

// The even bytes first, then the odd ones.
inline std::uint64_t apart(std::uint64_t w) {
  std::uint64_t t = (w ^ (w >> 8)) & 0x0000ff000000ff00;
  w ^= t ^ (t << 8);
  t = (w ^ (w >> 16)) & 0x00000000ffff0000;
  return w ^ t ^ (t << 16);
}

// Bit i of byte l becomes bit l of byte i (Warren, Hacker's Delight, 7-3).
inline std::uint64_t transposed(std::uint64_t m) {
  std::uint64_t t = (m ^ (m >> 7)) & 0x00aa00aa00aa00aa;
  m ^= t ^ (t << 7);
  t = (m ^ (m >> 14)) & 0x0000cccc0000cccc;
  m ^= t ^ (t << 14);
  t = (m ^ (m >> 28)) & 0x00000000f0f0f0f0;
  return m ^ t ^ (t << 28);
}

}  // namespace

template <int D>
unsigned PairTest<D>::run(const Slice<D>& slice, const Neighbourhood<D>& near, const SliceGroup<D>& group) {
  const std::size_t most = near.slices.size() + floats;
  if (places_.size() < most) {
    places_.resize(2 * most);
    slices_.resize(2 * most);
    matches_.resize(2 * most);
    first_lanes_.resize(most);
    last_lanes_.resize(most);
  }
  doubtful_.clear();
  double least = std::numeric_limits<double>::infinity();
  bool all = !near.compact;
  if (near.compact) {
    const auto own = static_cast<std::size_t>(near.own + slice.first / lanes - group.begin);
    pick(near, own);
    const auto picked = places_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto self = static_cast<std::size_t>(
        std::lower_bound(places_.begin(), picked, static_cast<Index>(own)) - places_.begin());
    places_[self] = places_[count_] = near.far_slice();
    all = radii_.graded() ? test<true>(near, own) : test<false>(near, own);
    set_matches();
    doubtful_.push_back(self);
  } else {
    count_ = near.slices.size();
    std::copy(near.slices.begin(), near.slices.end(), slices_.begin());
  }
  if (all) {
    for (std::size_t i = 0; i < count_; ++i) matches_[i] = exact(slice, slices_[i], least);
  } else {
    for (const std::size_t i : doubtful_)
      if (i < count_) matches_[i] = exact(slice, slices_[i], least);
  }
  if (radii_.coincident) return 0;
  return least > slice.reach * slice.reach * coincident2 ? 0 : coincident_lanes(slice, near);
}

// The slices whose boxes are nearer to that of the slice at `own` than a radius.
template <int D>
void PairTest<D>::pick(const Neighbourhood<D>& near, std::size_t own) {
  Float16 low[D], high[D];
  const float *lows[D], *highs[D];
  for (int d = 0; d < D; ++d) {
    low[d] = splat16(near.low[d][own]);
    high[d] = splat16(near.high[d][own]);
    lows[d] = near.low[d].data();
    highs[d] = near.high[d].data();
  }
  const float* const reach2 = near.reach2.data();
  const Float16 own_reach2 = splat16(reach2[own]), zero = splat16(0), tolerance = splat16(near.tolerance);
  const auto n = static_cast<Index>(near.slices.size());
  Index* out = places_.data();
  for (Index i = 0; i < n; i += floats) {
    Float16 d2 = zero - tolerance;
    for (int d = 0; d < D; ++d) {
      const Float16 gap =
          max(zero, max(low[d] - load16(highs[d] + i), load16(lows[d] + i) - high[d]));  // NaN stays NaN
      d2 = multiply_add(gap, gap, d2);
    }
    const unsigned picked = less(d2, max(own_reach2, load16(reach2 + i)));
    out = store_places(i, picked & 0xff, out);
    out = store_places(i + lanes, picked >> lanes, out);
  }
  count_ = static_cast<std::size_t>(out - places_.data());
  for (std::size_t i = 0; i < count_; ++i) slices_[i] = near.slices[static_cast<std::size_t>(places_[i])];
}

// Returns whether any two particles may coincide.
template <int D>
template <bool graded>
bool PairTest<D>::test(const Neighbourhood<D>& near, std::size_t self) {
  FloatRegister own[D][lanes], own_r2[lanes];
  for (int l = 0; l < lanes; ++l) {
    const std::size_t at = self * lanes + static_cast<std::size_t>(l);
    for (int d = 0; d < D; ++d) own[d][l] = splat_register(near.x[d][at]);
    own_r2[l] = splat_register(graded ? -near.r2[at] : -near.reach2[self]);
  }
  const float* other[D];
  for (int d = 0; d < D; ++d) other[d] = near.x[d].data();
  const float* const other_r2 = near.r2.data();
  const FloatRegister zero = splat_register(0), tolerance = splat_register(near.tolerance),
                      infinite = splat_register(std::numeric_limits<float>::infinity());
  const Index* const places = places_.data();
  FloatRegister least[2] = {infinite, infinite};  // two, to wait for the last but one
  for (std::size_t i = 0; i < count_; i += 2) {
    const auto a = static_cast<std::size_t>(places[i]) * lanes,
               b = static_cast<std::size_t>(places[i + 1]) * lanes;
    FloatRegister margin[2] = {infinite, infinite};
    std::uint64_t rows[2] = {0, 0};
    for (int first = 0; first < floats; first += FloatRegister::size) {
      FloatRegister x[D], r2 = zero;
      for (int d = 0; d < D; ++d) x[d] = load_of_two(first, other[d] + a, other[d] + b);
      if constexpr (graded) r2 = zero - load_of_two(first, other_r2 + a, other_r2 + b);
#pragma GCC unroll 8
      for (int l = 0; l < lanes; ++l) {
        // Distance squared less the radius squared: negative where there is a pair.
        const FloatRegister minus_r2 = graded ? min(own_r2[l], r2) : own_r2[l];
        FloatRegister excess = minus_r2;
        for (int d = 0; d < D; ++d) {
          const FloatRegister gap = x[d] - own[d][l];
          excess = multiply_add(gap, gap, excess);
        }
        margin[l % 2] = least_magnitude(margin[l % 2], excess);
        least[l % 2] = min(graded ? excess - minus_r2 : excess, least[l % 2]);
        rows[l / 4] |= std::uint64_t{less(excess, zero)} << (16 * (l % 4) + first);
      }
    }
    first_lanes_[i / 2] = rows[0];
    last_lanes_[i / 2] = rows[1];
    if (less(min(margin[0], margin[1]), tolerance)) {
      doubtful_.push_back(i);
      doubtful_.push_back(i + 1);
    }
  }
  return less(min(least[0], least[1]), graded ? tolerance : own_r2[0] + tolerance) != 0;
}

template <int D>
void PairTest<D>::set_matches() {
  const std::uint64_t *first = first_lanes_.data(), *last = last_lanes_.data();
  std::uint64_t* const matches = matches_.data();
  const std::size_t pairs = (count_ + 1) / 2;
#pragma omp simd
  for (std::size_t i = 0; i < pairs; ++i) {
    const std::uint64_t a = apart(first[i]), b = apart(last[i]);
    matches[2 * i] = transposed((a & 0xffffffff) | b << 32);
    matches[2 * i + 1] = transposed(a >> 32 | (b & 0xffffffff00000000));
  }
}

// The pairs with another slice by the definition's arithmetic.
template <int D>
std::uint64_t PairTest<D>::exact(const Slice<D>& slice, Index other, double& least) const {
  Double8 x[D];
  for (int d = 0; d < D; ++d) x[d] = load8(slice.x[d]);
  const Double8 own_r2 = load8(slice.r2);
  Double8 nearest = splat8(least);
  std::uint64_t result = 0;
  const Index first = other * lanes;
  for (Index b = first; b < std::min(first + lanes, points_.n); ++b) {
    Double8 d2;
    for (int d = 0; d < D; ++d) {
      const Double8 dx = x[d] - splat8(points_.x[d][b]);
      d2 = d == 0 ? dx * dx : d2 + dx * dx;
    }
    Double8 r2 = own_r2;
    if (radii_.graded()) r2 = max(own_r2, splat8(radii_(b) * radii_(b)));
    const std::uint32_t lane = std::min<std::uint32_t>(static_cast<std::uint32_t>(b - slice.first), lanes);
    d2 = d2 + load8(itself.data() + lanes - lane);
    result |= std::uint64_t{less(d2, r2)} << (8 * (b - first));
    nearest = min(d2, nearest);
  }
  double all[lanes];
  std::memcpy(all, &nearest, sizeof all);
  least = *std::min_element(all, all + lanes);
  return result;
}

template <int D>
unsigned PairTest<D>::coincident_lanes(const Slice<D>& slice, const Neighbourhood<D>& near) const {
  unsigned found = 0;
  for (const Index s : near.slices)
    for (Index b = s * lanes; b < std::min((s + 1) * lanes, points_.n); ++b)
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

template class PairTest<1>;
template class PairTest<2>;
template class PairTest<3>;

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
