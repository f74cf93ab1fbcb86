#include <algorithm>
#include <cmath>
#include <cstdint>
#include <taut/geometry/shape_volume.hpp>

namespace taut {

namespace {

// A number in 0 … 1 from a counter: the same on every machine.
double hashed(std::uint64_t k) {
  k = (k ^ (k >> 30)) * 0xbf58476d1ce4e5b9ull;
  k = (k ^ (k >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((k ^ (k >> 31)) >> 11) * 0x1p-53;
}

}  // namespace

template <int D>
double estimate_volume(const Shape<D>& shape, double cells) {
  constexpr double most = 1 << 16;
  const Vec<D> edges = shape.max() - shape.min();
  const double wanted = std::clamp(4 * cells, 4096.0, most);
  const double edge = std::pow(edges.prod() / wanted, 1.0 / D);
  std::int64_t count[D], all = 1;
  for (int d = 0; d < D; ++d) all *= count[d] = std::max<std::int64_t>(1, std::llround(edges[d] / edge));
  std::int64_t inside = 0;
  // Serial: a shape is the user's function, which may throw or be unfit for threads.
  for (std::int64_t k = 0; k < all; ++k) {
    Vec<D> X;
    std::int64_t rest = k;
    for (int d = 0; d < D; ++d) {
      const auto at = static_cast<double>(rest % count[d]) +
                      hashed(static_cast<std::uint64_t>(k) * D + static_cast<std::uint64_t>(d) + 1);
      X[d] = shape.min()[d] + edges[d] * at / static_cast<double>(count[d]);
      rest /= count[d];
    }
    inside += shape.contains(X);
  }
  return edges.prod() * static_cast<double>(inside) / static_cast<double>(all);
}

template double estimate_volume<1>(const Shape<1>&, double);
template double estimate_volume<2>(const Shape<2>&, double);
template double estimate_volume<3>(const Shape<3>&, double);

}  // namespace taut
