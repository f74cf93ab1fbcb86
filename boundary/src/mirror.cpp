#include <cmath>
#include <taut/boundary/mirror.hpp>

namespace taut {

template <int D>
MirrorMap<D>::MirrorMap(const std::vector<Plane>& planes, const std::vector<Vec<D>>& points, double reach,
                        double tolerance)
    : begin_(static_cast<Index>(points.size())) {
  // Images of images make the edges and corners: each plane reflects all that stands so far.
  struct Image {
    Index master;
    std::uint8_t flips;
    Vec<D> twice;
    Vec<D> at;
  };
  std::vector<Image> all;
  for (std::size_t i = 0; i < points.size(); ++i)
    all.push_back({static_cast<Index>(i), 0, Vec<D>::Zero(), points[i]});
  for (const Plane& plane : planes) {
    const std::size_t before = all.size();
    for (std::size_t k = 0; k < before; ++k) {
      const double depth = std::abs(all[k].at[plane.axis] - plane.at);
      if (depth <= tolerance || depth >= reach) continue;
      Image image = all[k];
      image.flips ^= static_cast<std::uint8_t>(1 << plane.axis);
      image.twice[plane.axis] = 2 * plane.at - image.twice[plane.axis];
      image.at[plane.axis] = 2 * plane.at - image.at[plane.axis];
      all.push_back(image);
    }
  }
  for (std::size_t k = points.size(); k < all.size(); ++k) {
    master_.push_back(all[k].master);
    flips_.push_back(all[k].flips);
    twice_plane_.push_back(all[k].twice);
  }
}

template <int D>
Vec<D> MirrorMap<D>::image(Index k, const Vec<D>& point) const {
  Vec<D> at = twice_plane_[k];
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
