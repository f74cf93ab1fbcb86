#include "neighbourhood.hpp"

#include <algorithm>
#include <limits>

#include "lanes.hpp"

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {
namespace {

// Coordinates of the group are at most `extent` radii from the middle, those of candidates a radius more. So
// differences are off by 2^-24 (2 extent + 3), and squared distances near one by 4 times this and by
// rounding: less than half of what is allowed.
float tolerance_of(double extent) { return static_cast<float>(1e-6 * (extent + 3)); }

}  // namespace

template <int D>
void Neighbourhood<D>::gather(const PointView<D>& points, const Radii& radii, const Clusters<D>& clusters,
                              const SliceGroup<D>& group) {
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
    rows_ = AlignedArray<float>(2 * filled * lanes);
    if (radii.graded()) r2 = AlignedArray<float>(2 * filled * lanes);
  }

  double reach = group.reach;
  if (radii.graded())
    for (const Index s : slices) reach = std::max(reach, clusters.box(s).radius);
  scale = 1 / reach;
  double extent = 0;
  for (int d = 0; d < D; ++d) {
    origin[d] = group.box.low[d] + (group.box.high[d] - group.box.low[d]) / 2;
    extent = std::max(extent, (group.box.high[d] - group.box.low[d]) * scale / 2);
  }
  tolerance = tolerance_of(extent);

  // Rows of SliceBox: low corner, radius, high corner.
  double middle[lanes] = {};
  for (int d = 0; d < D; ++d) middle[d] = middle[4 + d] = origin[d];
  const Double8 middles = load8(middle), scales = splat8(scale);
  for (std::size_t i = 0; i < n; ++i) {
    if (i + lanes < n) __builtin_prefetch(clusters.box(slices[i + lanes]).low);
    for (int d = 0; d < D; ++d) __builtin_prefetch(points.x[d] + slices[i] * lanes);
    store_floats((load8(clusters.box(slices[i]).low) - middles) * scales, rows_.data() + i * lanes);
  }
  float columns[lanes * lanes];
  for (std::size_t i = 0; i < n; i += lanes) {
    transpose8(rows_.data() + i * lanes, lanes, columns, lanes);
    for (int d = 0; d < D; ++d) {
      std::memcpy(low[d].data() + i, columns + d * lanes, lanes * sizeof(float));
      std::memcpy(high[d].data() + i, columns + (4 + d) * lanes, lanes * sizeof(float));
    }
    for (std::size_t l = 0; l < lanes; ++l) reach2[i + l] = columns[3 * lanes + l] * columns[3 * lanes + l];
  }
  for (std::size_t i = n; i < filled; ++i) low[0][i] = std::numeric_limits<float>::quiet_NaN();

  for (int d = 0; d < D; ++d) {
    const Double8 middle_d = splat8(origin[d]);
    float* const out = x[d].data();
    for (std::size_t i = 0; i < n; ++i) {
      const Index first = slices[i] * lanes;
      if (first + lanes <= points.n) {
        store_floats((load8(points.x[d] + first) - middle_d) * scales, out + i * lanes);
      } else {
        for (int l = 0; l < lanes; ++l)
          out[i * lanes + static_cast<std::size_t>(l)] = first + l < points.n
                                                             ? local(points.x[d][first + l], d)
                                                             : std::numeric_limits<float>::quiet_NaN();
      }
    }
    std::fill_n(out + n * lanes, lanes, std::numeric_limits<float>::infinity());
  }
  if (!radii.graded()) return;
  for (std::size_t i = 0; i < n; ++i) {
    const Index first = slices[i] * lanes;
    if (first + lanes <= points.n) {
      const Double8 r = load8(radii.each.data() + first) * scales;
      store_floats(r * r, r2.data() + i * lanes);
    } else {
      for (int l = 0; l < lanes; ++l) {
        const double r = first + l < points.n ? radii(first + l) * scale : 0;
        r2[i * lanes + static_cast<std::size_t>(l)] = static_cast<float>(r * r);
      }
    }
  }
  std::fill_n(r2.data() + n * lanes, lanes, 0.0f);
}

template struct Neighbourhood<1>;
template struct Neighbourhood<2>;
template struct Neighbourhood<3>;

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
