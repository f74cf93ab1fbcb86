#include <fmt/format.h>

#include <cmath>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/base/fields.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/operators/patch_fit.hpp>

namespace taut {

namespace {

/// A monomial is left out where the samples tell it from those before it by less than this part of its
/// square. Corners of lattices leave 1e-2 at a radius of 3.2 spacings; two layers of moved cells 1e-6 of what
/// is quadratic across them.
constexpr double undetermined = 1e-3;

/// First column of the inverse of a normal matrix whose monomials stand in ascending degree. Those that
/// depend on earlier ones are left out: zero in the result. By Gauss-Jordan elimination.
template <int N>
Fixed<N, 1> first_of_inverse(Fixed<N> normal) {
  const Fixed<N, 1> size = normal.diagonal();
  Fixed<N, 1> z = Fixed<N, 1>::Unit(0);
  for (int k = 0; k < N; ++k) {
    const double pivot = normal(k, k);
    if (!(pivot > undetermined * size[k])) {
      normal.row(k).setZero();
      z[k] = 0;
      continue;
    }
    normal.row(k) /= pivot;
    z[k] /= pivot;
    for (int i = 0; i < N; ++i) {
      if (i == k) continue;
      const double factor = normal(i, k);
      normal.row(i) -= factor * normal.row(k);
      z[i] -= factor * z[k];
    }
  }
  return z;
}

template <class Points>
void check_groups(const Points& points, const char* what) {
  if (points.X.size() != points.group.size())
    throw InputError(
        fmt::format("patch fit: {} {} but {} groups", points.X.size(), what, points.group.size()));
}

}  // namespace

template <int D>
typename PatchFit<D>::Terms PatchFit<D>::monomials(const Vec<D>& distance) const {
  const Vec<D> s = distance / radius_;
  Terms t;
  t[0] = 1;
  t.template segment<D>(1) = s;
  for (int i = 0, k = 1 + D; i < D; ++i)
    for (int j = i; j < D; ++j) t[k++] = s[i] * s[j];
  return t;
}

template <int D>
double PatchFit<D>::weight(const Vec<D>& distance) const {
  const double q = distance.norm() / radius_;
  const double square = (1 - q) * (1 - q);
  return q < 1 ? square * square * (1 + 4 * q) : 0;
}

/// z with sum_b w_b (z . m_b) f_b = f(target) for all f of the monomials m that the patch determines.
template <int D>
typename PatchFit<D>::Terms PatchFit<D>::functional(Index target) const {
  Fixed<terms> normal = Fixed<terms>::Zero();
  for (const Index b : patch(target)) {
    const Vec<D> distance = samples_[static_cast<std::size_t>(b)] - X_[static_cast<std::size_t>(target)];
    const Terms m = monomials(distance);
    normal += weight(distance) * m * m.transpose();
  }
  return first_of_inverse<terms>(normal);
}

template <int D>
PatchFit<D>::PatchFit(const PatchPoints<D>& targets, const PatchPoints<D>& samples, double radius,
                      const std::function<bool(Index, Index)>& sees, bool coincident)
    : radius_(radius), X_(targets.X), samples_(samples.X), functional_(targets.X.size()) {
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError(fmt::format("patch fit: the radius {:g} must be positive", radius));
  check_groups(targets, "targets");
  check_groups(samples, "samples");
  // Targets that are the samples are neighbours of each other and of themselves; otherwise samples follow.
  const bool same = targets.X == samples.X;
  const auto n = static_cast<Index>(X_.size());
  Field all(X_.size() + (same ? 0 : samples_.size()), D);
  for (std::size_t i = 0; i < X_.size(); ++i) all.set_vec<D>(i, X_[i]);
  if (!same)
    for (std::size_t k = 0; k < samples_.size(); ++k) all.set_vec<D>(X_.size() + k, samples_[k]);
  const Index first = same ? 0 : n;
  const PairList pairs = find_pairs<D>(points_of<D>(all, first + static_cast<Index>(samples_.size())), radius,
                                       {.coincident = coincident});
  begin_.push_back(0);
  for (Index t = 0; t < n; ++t) {
    const Index group = targets.group[static_cast<std::size_t>(t)];
    if (same) patch_.push_back(t);
    pairs.for_each(t, [&](Index b, std::int64_t, int) {
      if (b >= first && samples.group[static_cast<std::size_t>(b - first)] == group &&
          (!sees || sees(t, b - first)))
        patch_.push_back(b - first);
    });
    if (patch_.size() == begin_.back())
      throw InputError(fmt::format("patch fit: no sample of its group within {:g} m of target {} at {}",
                                   radius, t, describe<D>(X_[static_cast<std::size_t>(t)])));
    begin_.push_back(patch_.size());
  }
#pragma omp parallel for schedule(dynamic, 256)
  for (Index t = 0; t < n; ++t) functional_[static_cast<std::size_t>(t)] = functional(t);
}

template <int D>
std::vector<Mat<D>> PatchFit<D>::operator()(std::span<const Mat<D>> values) const {
  if (values.size() != samples_.size())
    throw InputError(fmt::format("patch fit: {} values for {} samples", values.size(), samples_.size()));
  std::vector<Mat<D>> fitted(X_.size(), Mat<D>::Zero());
#pragma omp parallel for schedule(static)
  for (std::size_t t = 0; t < X_.size(); ++t)
    for (const Index b : patch(static_cast<Index>(t))) {
      const auto k = static_cast<std::size_t>(b);
      const Vec<D> distance = samples_[k] - X_[t];
      fitted[t] += weight(distance) * functional_[t].dot(monomials(distance)) * values[k];
    }
  return fitted;
}

template <int D>
std::size_t PatchFit<D>::bytes() const {
  return (X_.size() + samples_.size()) * sizeof(Vec<D>) + begin_.size() * sizeof(begin_[0]) +
         patch_.size() * sizeof(Index) + functional_.size() * sizeof(Terms);
}

template class PatchFit<1>;
template class PatchFit<2>;
template class PatchFit<3>;

}  // namespace taut
