#include <taut/base/error.hpp>
#include <taut/base/small_solve.hpp>
#include <taut/geometry/geometry.hpp>

namespace taut {

template <int D>
double close_areas(Cloud<D>& cloud) {
  using Basis = Fixed<D + 1, 1>;
  Vec<D> centre = Vec<D>::Zero();
  for (const Vec<D>& X : cloud.X) centre += X / static_cast<double>(cloud.size());
  // f(area, where it acts) for each piece of the boundary that there is.
  const auto each = [&](auto&& f) {
    for (Facet<D>& facet : cloud.facets) f(facet.area, facet.centre);
    if (!cloud.facets.empty()) return;
    for (std::size_t a = 0; a < cloud.B.size(); ++a)
      if (!cloud.B[a].isZero(0)) f(cloud.B[a], cloud.X[a]);
  };
  double volume = 0, total = 0, change = 0;
  for (const double V : cloud.V) volume += V;
  Fixed<D + 1> normal = Fixed<D + 1>::Zero();
  Fixed<D + 1, D> defect = Fixed<D + 1, D>::Zero();  // [sum A; sum x (x) A]
  const auto basis = [&](const Vec<D>& x) {
    Basis f;
    f << 1, (x - centre) / cloud.dx;
    return f;
  };
  for (int d = 0; d < D; ++d) defect(d + 1, d) = volume / cloud.dx;
  each([&](const Vec<D>& A, const Vec<D>& x) {
    const Basis f = basis(x);
    normal += A.norm() * f * f.transpose();
    defect -= f * A.transpose();
    total += A.norm();
  });
  if (!solve_small(normal, defect))
    throw InputError("the boundary areas do not enclose the body: its surface particles lie on one plane");
  const Fixed<D + 1, D>& multiplier = defect;
  each([&](Vec<D>& A, const Vec<D>& x) {
    const Vec<D> delta = A.norm() * (multiplier.transpose() * basis(x));
    change += delta.norm();
    A += delta;
  });
  return change / total;
}

template double close_areas<1>(Cloud<1>&);
template double close_areas<2>(Cloud<2>&);
template double close_areas<3>(Cloud<3>&);

}  // namespace taut
