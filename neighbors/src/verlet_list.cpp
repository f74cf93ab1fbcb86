#include <fmt/format.h>

#include <cmath>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/neighbors/verlet_list.hpp>

namespace taut {

template <int D>
VerletList<D>::VerletList(double radius, double skin, SearchOptions options)
    : radius_(radius), skin_(skin), options_(options) {
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError(fmt::format("radius {}: a support radius is a finite length greater than 0", radius));
  if (!(skin >= 0) || !std::isfinite(skin))
    throw InputError(
        fmt::format("skin {}: a skin is a fraction of the radius, 0 or more (0.1 is usual)", skin));
}

template <int D>
bool VerletList<D>::due(PointView<D> x) {
  if (builds_ == 0 || x.n != pairs_.particles()) return true;
  double largest = 0;
  bool finite = true;
#pragma omp parallel for schedule(static) reduction(max : largest) reduction(&& : finite) if (worth_threads(x.n))
  for (Index i = 0; i < x.n; ++i) {
    double d2 = 0;
    for (int d = 0; d < D; ++d) {
      const double u = x.x[d][i] - built_at_.component(d)[i];
      d2 += u * u;
    }
    finite = finite && std::isfinite(d2);
    largest = std::max(largest, d2);
  }
  displacement_ = std::sqrt(largest);
  return !(finite && displacement_ <= skin_ * radius_ / 2);
}

template <int D>
bool VerletList<D>::update(PointView<D> x) {
  if (!due(x)) return false;
  pairs_ = find_pairs(x, reach(), options_);
  if (built_at_.empty() || built_at_.particles() != static_cast<std::size_t>(x.n))
    built_at_ = Field(static_cast<std::size_t>(x.n), D);
  for (int d = 0; d < D; ++d) std::copy_n(x.x[d], x.n, built_at_.component(d));
  displacement_ = 0;
  ++builds_;
  return true;
}

template class VerletList<1>;
template class VerletList<2>;
template class VerletList<3>;

}  // namespace taut
