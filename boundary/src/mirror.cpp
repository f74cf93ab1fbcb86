#include <cmath>
#include <taut/boundary/mirror.hpp>
#include <utility>

namespace taut {

template <int D>
MirrorMap<D>::MirrorMap(std::vector<Plane> planes, std::vector<Period> periods,
                        const std::vector<Vec<D>>& points, double reach, double tolerance)
    : planes_(std::move(planes)), periods_(std::move(periods)), reach_(reach), tolerance_(tolerance) {
  find(points);
}

template <int D>
void MirrorMap<D>::follow(const Field& x, Index n) {
  std::vector<Vec<D>> points(static_cast<std::size_t>(n));
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = x.vec<D>(i);
  find(points);
}

template <int D>
void MirrorMap<D>::find(const std::vector<Vec<D>>& points) {
  // Images of images make the edges and corners: each plane and period repeats all that stands so far.
  struct Image {
    Index master;
    std::uint8_t flips;
    Vec<D> offset, at;
  };
  std::vector<Image> images;
  const auto for_all = [&](auto&& f) {
    const std::size_t before = images.size();
    for (std::size_t i = 0; i < points.size(); ++i)
      f(Image{static_cast<Index>(i), 0, Vec<D>::Zero(), points[i]});
    for (std::size_t k = 0; k < before; ++k) f(Image(images[k]));
  };
  for (const Plane& plane : planes_)
    for_all([&](Image image) {
      const double depth = std::abs(image.at[plane.axis] - plane.at);
      if (depth <= tolerance_ || depth >= reach_) return;
      image.flips ^= static_cast<std::uint8_t>(1 << plane.axis);
      image.offset[plane.axis] = 2 * plane.at - image.offset[plane.axis];
      image.at[plane.axis] = 2 * plane.at - image.at[plane.axis];
      images.push_back(image);
    });
  for (const Period& period : periods_) {
    const int turns = static_cast<int>(std::ceil(reach_ / period.length));
    for_all([&](const Image& of) {
      for (int turn = -turns; turn <= turns; ++turn) {
        const double beyond = of.at[period.axis] + turn * period.length - period.low;
        if (turn == 0 || !(beyond > -reach_ && beyond < period.length + reach_)) continue;
        images.push_back(of);
        images.back().offset[period.axis] += turn * period.length;
        images.back().at[period.axis] += turn * period.length;
      }
    });
  }
  begin_ = static_cast<Index>(points.size());
  master_.clear();
  flips_.clear();
  offset_.clear();
  for (const Image& image : images) {
    master_.push_back(image.master);
    flips_.push_back(image.flips);
    offset_.push_back(image.offset);
  }
}

template <int D>
Vec<D> MirrorMap<D>::wrap(const Vec<D>& x) const {
  Vec<D> shift = Vec<D>::Zero();
  for (const Period& period : periods_)
    shift[period.axis] = -std::floor((x[period.axis] - period.low) / period.length) * period.length;
  return shift;
}

template <int D>
Vec<D> MirrorMap<D>::nearest(Vec<D> difference) const {
  for (const Period& period : periods_)
    difference[period.axis] -= std::round(difference[period.axis] / period.length) * period.length;
  return difference;
}

template <int D>
Vec<D> MirrorMap<D>::image(Index k, const Vec<D>& point) const {
  Vec<D> at = offset_[static_cast<std::size_t>(k)];
  for (int d = 0; d < D; ++d) at[d] += (flips_[k] >> d & 1) ? -point[d] : point[d];
  return at;
}

template <int D>
void MirrorMap<D>::positions(Field& x) const {
  for (Index k = 0; k < size(); ++k) x.set_vec<D>(begin_ + k, image(k, x.vec<D>(master_[k])));
}

template <int D>
void MirrorMap<D>::vectors(Field& v) const {
  for (Index k = 0; k < size(); ++k)
    for (int d = 0; d < D; ++d) {
      double* vd = v.component(d);
      vd[begin_ + k] = (flips_[k] >> d & 1) ? -vd[master_[k]] : vd[master_[k]];
    }
}

template <int D>
void MirrorMap<D>::tensors(Field& T) const {
  for (Index k = 0; k < size(); ++k)
    for (int r = 0; r < D; ++r)
      for (int c = 0; c < D; ++c) {
        double* t = T.component(r * D + c);
        const bool odd = ((flips_[k] >> r) ^ (flips_[k] >> c)) & 1;
        t[begin_ + k] = odd ? -t[master_[k]] : t[master_[k]];
      }
}

template <int D>
void MirrorMap<D>::scalars(Field& f) const {
  for (int c = 0; c < f.components(); ++c) {
    double* values = f.component(c);
    for (Index k = 0; k < size(); ++k) values[begin_ + k] = values[master_[k]];
  }
}

template <int D>
void MirrorMap<D>::symmetric(Field& s) const {
  constexpr int pairs[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  constexpr int pairs_2d[3][2] = {{0, 0}, {1, 1}, {0, 1}};
  for (int c = 0; c < s.components(); ++c) {
    const int* axes = D == 2 ? pairs_2d[c] : pairs[c];
    double* values = s.component(c);
    for (Index k = 0; k < size(); ++k) {
      const bool odd = ((flips_[k] >> axes[0]) ^ (flips_[k] >> axes[1])) & 1;
      values[begin_ + k] = odd ? -values[master_[k]] : values[master_[k]];
    }
  }
}

template class MirrorMap<1>;
template class MirrorMap<2>;
template class MirrorMap<3>;

}  // namespace taut
