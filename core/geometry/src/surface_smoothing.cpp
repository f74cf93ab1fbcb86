#include <algorithm>
#include <cmath>
#include <taut/geometry/surface.hpp>

namespace taut {
namespace {

constexpr int rounds = 12;
constexpr double same_face = 0.5;  // cosine of the angle from which on two normals are of two faces

// One at equal normals, zero from same_face on.
double likeness(double cosine) {
  const double t = std::max(0.0, (cosine - same_face) / (1 - same_face));
  return t * t;
}

}  // namespace

template <int D>
Surface<D>::Surface(const std::vector<Vec<D>>& X, const BodyMesh<D>& mesh) {
  std::vector<Index> vertex(X.size(), no_particle);
  for (const BoundaryFace<D>& face : mesh.boundary) {
    std::array<Index, D> own{};
    for (std::size_t k = 0; k < D; ++k) {
      const auto p = static_cast<std::size_t>(face.vertex[k]);
      if (vertex[p] == no_particle) {
        vertex[p] = static_cast<Index>(x.size());
        x.push_back(X[p]);
        particle.push_back(face.vertex[k]);
      }
      own[k] = vertex[p];
    }
    facet.push_back(own);
    sign.push_back(face.sign);
  }
  first.assign(x.size() + 1, 0);
  for (const auto& f : facet)
    for (const Index v : f) ++first[static_cast<std::size_t>(v) + 1];
  for (std::size_t v = 0; v < x.size(); ++v) first[v + 1] += first[v];
  around.resize(facet.size() * D);
  std::vector<std::size_t> next(first.begin(), first.end() - 1);
  for (std::size_t f = 0; f < facet.size(); ++f)
    for (const Index v : facet[f]) around[next[static_cast<std::size_t>(v)]++] = static_cast<Index>(f);
}

template <int D>
std::array<Vec<D>, D> Surface<D>::corners(std::size_t f) const {
  std::array<Vec<D>, D> c;
  for (std::size_t k = 0; k < D; ++k) c[k] = x[static_cast<std::size_t>(facet[f][k])];
  return c;
}

template <int D>
Vec<D> Surface<D>::centre(std::size_t f) const {
  Vec<D> sum = Vec<D>::Zero();
  for (const Vec<D>& c : corners(f)) sum += c;
  return sum / D;
}

template <int D>
double smooth(Surface<D>& surface) {
  const std::size_t n = surface.size();
  std::vector<Vec<D>> normal(n);
  std::vector<double> size(n);
  for (std::size_t f = 0; f < n; ++f) {
    normal[f] = surface.area(f);
    size[f] = normal[f].norm();
    normal[f].normalize();
  }
  const std::vector<Vec<D>> before = normal;
  std::vector<Vec<D>> mean(n);
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t f = 0; f < n; ++f) {
      Vec<D> sum = Vec<D>::Zero();
      surface.each_beside(
          f, [&](std::size_t g) { sum += size[g] * likeness(normal[f].dot(normal[g])) * normal[g]; });
      mean[f] = sum.normalized();
    }
    std::swap(normal, mean);
  }
  double turned = 0, total = 0;
  for (std::size_t f = 0; f < n; ++f) {
    turned += size[f] * (normal[f] - before[f]).squaredNorm();
    total += size[f];
  }
  // Each vertex goes to where the planes through the middles of its facets, with the new normals, want it.
  std::vector<Vec<D>> moved(surface.x.size());
  for (int round = 0; round < 4 * rounds; ++round) {
    for (std::size_t v = 0; v < surface.x.size(); ++v) {
      Vec<D> step = Vec<D>::Zero();
      double count = 0;
      surface.each_around(v, [&](std::size_t f) {
        step += size[f] * normal[f] * normal[f].dot(surface.centre(f) - surface.x[v]);
        count += size[f];
      });
      moved[v] = surface.x[v] + step / count;
    }
    std::swap(surface.x, moved);
  }
  return std::sqrt(turned / total);
}

template <int D>
void smooth(const Surface<D>& surface, std::vector<double>& value) {
  std::vector<Vec<D>> normal(surface.size());
  for (std::size_t f = 0; f < surface.size(); ++f) normal[f] = surface.area(f).normalized();
  std::vector<double> mean(surface.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t f = 0; f < surface.size(); ++f) {
      double sum = 0, weights = 0;
      surface.each_beside(f, [&](std::size_t g) {
        const double w = likeness(normal[f].dot(normal[g]));
        sum += w * value[g];
        weights += w;
      });
      mean[f] = sum / weights;
    }
    std::swap(value, mean);
  }
}

#define TAUT_INSTANTIATE(D)               \
  template struct Surface<D>;             \
  template double smooth<D>(Surface<D>&); \
  template void smooth<D>(const Surface<D>&, std::vector<double>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
