#include <algorithm>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/clusters.hpp>
#include <utility>

namespace taut::detail {
namespace {

// How long a cluster may be, in radii. Every search has to reach that much farther, hence the limits; a row
// of eight along the first coordinate, the order of lattices, is worth it.
constexpr double longest_row = 8, longest = 2;

// Hands the clusters of the lanes [begin, end) to `put`. One box for all lanes is best while they are near
// each other; else they are halved.
template <int D, class Put>
void split(const Slice<D>& slice, int begin, int end, Put&& put) {
  bool fits = true;
  const auto bound = [&](int from, int to) {
    Cluster<D> c;
    c.slice = slice.first / lanes;
    c.count = to - from;
    c.radius = *std::max_element(slice.radius + from, slice.radius + to);
    double volume = 1;
    fits = true;
    for (int d = 0; d < D; ++d) {
      double low = slice.x[d][from], high = low;
      for (int l = from + 1; l < to; ++l) {
        low = std::min(low, slice.x[d][l]);
        high = std::max(high, slice.x[d][l]);
      }
      c.box.low[d] = low;
      c.box.high[d] = high;
      fits = fits && high - low <= (d == 0 ? longest_row : longest) * c.radius;
      volume *= 1 + (high - low) / (2 * c.radius);
    }
    return std::pair(c, volume);  // of the search, in that of one lane alone
  };
  const auto [whole, volume] = bound(begin, end);
  if (end - begin > 1 && !(fits && volume < 2)) {
    const bool too_long = !fits;
    const int middle = (begin + end) / 2;
    if (too_long || !(volume <= bound(begin, middle).second + bound(middle, end).second)) {
      split(slice, begin, middle, put);
      split(slice, middle, end, put);
      return;
    }
  }
  put(whole);
}

}  // namespace

template <int D>
Clusters<D>::Clusters(const PointView<D>& points, const Radii& radii)
    : slices_(static_cast<Index>(padded(static_cast<std::size_t>(points.n)) / lanes)) {
  whole_ = AlignedArray<Cluster<D>>::for_overwrite(static_cast<std::size_t>(slices_));
  part_begin_.resize(static_cast<std::size_t>(slices_) + 1);
#pragma omp parallel for schedule(static) if (worth_threads(points.n))
  for (Index s = 0; s < slices_; ++s) {
    const Slice<D> slice = make_slice(points, radii, s);
    Index parts = 0;
    split(slice, 0, slice.count, [&](const Cluster<D>& c) {
      whole_[static_cast<std::size_t>(s)] = c;
      ++parts;
    });
    part_begin_[static_cast<std::size_t>(s)] = parts > 1 ? parts : 0;
  }
  Index total = 0;
  for (Index& b : part_begin_) total += std::exchange(b, total);
  if (total == 0) {
    part_begin_ = {};
    return;
  }
  parts_.resize(static_cast<std::size_t>(total));
#pragma omp parallel for schedule(static) if (worth_threads(points.n))
  for (Index s = 0; s < slices_; ++s) {
    if (whole(s)) continue;
    const Slice<D> slice = make_slice(points, radii, s);
    Cluster<D>* out = parts_.data() + part_begin_[static_cast<std::size_t>(s)];
    split(slice, 0, slice.count, [&](const Cluster<D>& c) { *out++ = c; });
  }
}

template class Clusters<1>;
template class Clusters<2>;
template class Clusters<3>;

}  // namespace taut::detail
