#include <taut/base/small_solve.hpp>
#include <taut/operators/facet_rows.hpp>

namespace taut {

namespace {

// The inverse on the directions that the neighbours span; zero across a sheet or a thread of particles.
template <int D>
Mat<D> inverse_of_spanned(const Mat<D>& moment) {
  constexpr double flat = 1e-6;
  const Spectrum<D> eigen = symmetric_eigen<D>(moment);
  const double largest = eigen.values[D - 1];
  Mat<D> inverse = Mat<D>::Zero();
  for (int d = 0; d < D; ++d)
    if (eigen.values[d] > flat * largest)
      inverse += eigen.vectors.col(d) * eigen.vectors.col(d).transpose() / eigen.values[d];
  return inverse;
}

}  // namespace

template <int D>
FacetRows<D>::FacetRows(const std::vector<Facet<D>>& facets, const Particles<D>& p, const PairList& pairs) {
  begin_.reserve(facets.size() + 1);
  for (const Facet<D>& facet : facets) {
    const Index o = p.place[static_cast<std::size_t>(facet.owner)];
    const Vec<D> Xo = p.X.template vec<D>(static_cast<std::size_t>(o)), to_facet = facet.centre - Xo;
    const std::size_t first = terms_.size();
    terms_.push_back({o, 0, 1});
    if (to_facet.squaredNorm() > 1e-20 * p.dx * p.dx) {
      Mat<D> moment = Mat<D>::Zero();
      const auto each = [&](auto&& f) {
        pairs.for_each(o, [&](Index b, std::int64_t, int) {
          f(b, Vec<D>(p.X.template vec<D>(static_cast<std::size_t>(b)) - Xo));
        });
      };
      each([&](Index, const Vec<D>& X) { moment += X * X.transpose(); });
      const Vec<D> direction = inverse_of_spanned<D>(moment) * to_facet;
      double sum = 0;
      each([&](Index b, const Vec<D>& X) {
        const double weight = X.dot(direction);
        if (weight == 0) return;
        sum += weight;
        if (b < p.n)
          terms_.push_back({b, 0, weight});
        else
          terms_.push_back({p.mirror.master(b - p.n), p.mirror.flips(b - p.n), weight});
      });
      terms_[first].weight -= sum;
    }
    begin_.push_back(terms_.size());
  }
}

template class FacetRows<1>;
template class FacetRows<2>;
template class FacetRows<3>;

}  // namespace taut
