#include <algorithm>
#include <cstring>
#include <limits>
#include <taut/neighbors/lanes.hpp>
#include <taut/neighbors/neighbourhood.hpp>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {
namespace {

// Coordinates of the group are at most `extent` radii from the middle, those of candidates a radius more. So
// differences are off by 2^-24 (2 extent + 3), and squared distances near one by 4 times this and by
// rounding: less than half of what is allowed.
float tolerance_of(double extent) { return static_cast<float>(1e-6 * (extent + 3)); }

double largest(const Double8& a) {
  double all[lanes];
  std::memcpy(all, &a, sizeof all);
  return *std::max_element(all, all + lanes);
}

}  // namespace

template <int D>
void Neighbourhood<D>::gather(const PointView<D>& points, const Radii& radii, const SliceGroup<D>& group) {
  compact = group.compact;
  own = static_cast<Index>(std::lower_bound(slices.begin(), slices.end(), group.begin) - slices.begin());
  if (!compact) return;

  const std::size_t n = slices.size(), filled = n + floats;
  if (reach2.size() < filled) {
    for (int d = 0; d < D; ++d) {
      low[d] = AlignedArray<float>(2 * filled);
      high[d] = AlignedArray<float>(2 * filled);
      x[d] = AlignedArray<float>(2 * filled * lanes);
    }
    reach2 = AlignedArray<float>(2 * filled);
    if (radii.graded()) r2 = AlignedArray<float>(2 * filled * lanes);
  }

  // The last slice of all may be short: it is copied from here.
  const bool is_short = slices.back() * lanes > points.n - lanes;
  const std::size_t long_slices = n - is_short;
  double rest[lanes];
  const auto load_short = [&](const double* numbers, double none) {
    const Index first = slices.back() * lanes;
    for (int l = 0; l < lanes; ++l) rest[l] = first + l < points.n ? numbers[first + l] : none;
    return load8(rest);
  };

  double reach = group.reach;
  if (radii.graded()) {
    const double* const r = radii.each.data();
    Double8 all = is_short ? load_short(r, 0) : splat8(0);
    for (std::size_t i = 0; i < long_slices; ++i) all = max(all, load8(r + slices[i] * lanes));
    reach = std::max(reach, largest(all));
  }
  const double scale = 1 / reach;
  const Double8 scales = splat8(scale);
  double extent = 0;
  for (int d = 0; d < D; ++d) extent = std::max(extent, (group.box.high[d] - group.box.low[d]) * scale / 2);
  tolerance = tolerance_of(extent);

  for (int d = 0; d < D; ++d) {
    const Double8 middle = splat8(group.box.low[d] + (group.box.high[d] - group.box.low[d]) / 2);
    const double* const from = points.x[d];
    const Index* const slice = slices.data();
    float* const to = x[d].data();
    constexpr std::size_t ahead = 16;
    for (std::size_t i = 0; i < long_slices; ++i) {
      __builtin_prefetch(from + slice[std::min(i + ahead, long_slices - 1)] * lanes);
      store_floats((load8(from + slice[i] * lanes) - middle) * scales, to + i * lanes);
    }
    if (is_short)
      store_floats((load_short(from, std::numeric_limits<double>::quiet_NaN()) - middle) * scales,
                   to + long_slices * lanes);
    for (std::size_t i = 0; i < n; i += lanes)
      bound_rows(to + i * lanes, low[d].data() + i, high[d].data() + i);
    std::fill_n(to + n * lanes, lanes, std::numeric_limits<float>::infinity());
  }
  std::fill_n(low[0].data() + n, floats, std::numeric_limits<float>::quiet_NaN());

  if (!radii.graded()) {
    const auto r = static_cast<float>(radii.one * scale);
    std::fill_n(reach2.data(), n, r * r);
    return;
  }
  const auto store_squares = [&](const Double8& r, std::size_t i) {
    const Double8 scaled = r * scales;
    store_floats(scaled * scaled, r2.data() + i * lanes);
  };
  for (std::size_t i = 0; i < long_slices; ++i)
    store_squares(load8(radii.each.data() + slices[i] * lanes), i);
  if (is_short) store_squares(load_short(radii.each.data(), 0), long_slices);
  float least[lanes];
  for (std::size_t i = 0; i < n; i += lanes) bound_rows(r2.data() + i * lanes, least, reach2.data() + i);
  std::fill_n(r2.data() + n * lanes, lanes, 0.0f);
}

template struct Neighbourhood<1>;
template struct Neighbourhood<2>;
template struct Neighbourhood<3>;

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
