#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <taut/core/error.hpp>
#include <taut/core/operators.hpp>
#include <taut/internal/compatible_operator.hpp>
#include <utility>

namespace taut {

namespace {

template <int D>
std::string describe(const Vec<D>& X) {
  std::string text = "(";
  for (int d = 0; d < D; ++d) text += fmt::format("{}{:g}", d ? ", " : "", X[d]);
  return text + ")";
}

// G_ab = V_a V_b grad W_ab for all slots; antisymmetric to the last bit, because every factor is.
template <int D, class Real>
void fill_vectors(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h, AlignedArray<Real>& out) {
  out = AlignedArray<Real>(static_cast<std::size_t>(pairs.slots()) * D * lanes);
  const double* V = p.V.component(0);
#pragma omp parallel for schedule(dynamic, 64)
  for (Index s = 0; s < pairs.slices(); ++s)
    for (Index a = s * lanes; a < std::min<Index>((s + 1) * lanes, pairs.particles()); ++a)
      pairs.for_each(a, [&](Index b, std::int64_t k, int lane) {
        const Vec<D> rab = p.X.template vec<D>(a) - p.X.template vec<D>(b);
        const double r = rab.norm();
        const double w = V[a] * V[b] * kernel.derivative(r, h) / r;
        for (int d = 0; d < D; ++d)
          out[static_cast<std::size_t>((k * D + d) * lanes + lane)] = static_cast<Real>(w * rab[d]);
      });
}

template <int D>
[[noreturn]] void throw_singular(const Particles<D>& p, const PairList& pairs, Index a) {
  Index neighbours = 0;
  pairs.for_each(a, [&](Index, std::int64_t, int) { ++neighbours; });
  throw InputError(fmt::format(
      "corrected operator: the correction matrix of particle {} at {} is singular: its {} neighbour(s) do not span {} "
      "dimension(s). Enlarge support_dx, refine dx, or thicken the body there",
      p.id[a], describe<D>(p.X.template vec<D>(a)), neighbours, D));
}

// M_a = I / V_a, and what the gradient of X lacks to be I.
template <int D>
void leave_uncorrected(const Particles<D>& p, const PairList& pairs, PairOperator<D>& op) {
  op.F0 = Field(static_cast<std::size_t>(p.total), D * D);
#pragma omp parallel for schedule(dynamic, 512)
  for (Index a = 0; a < p.n; ++a) {
    const double V = p.V.component(0)[a];
    Mat<D> gradient = Mat<D>::Zero();
    pairs.for_each(a, [&](Index b, std::int64_t k, int lane) {
      gradient += (p.X.template vec<D>(b) - p.X.template vec<D>(a)) * op.vector(k, lane).transpose();
    });
    op.M.template set_mat<D>(a, Mat<D>::Identity() / V);
    op.F0.template set_mat<D>(a, Mat<D>::Identity() - gradient / V);
  }
}

// M_a = [sum_b G_ab (x) X_ab]^-1 of the pair vectors as stored.
template <int D>
void correct(const Particles<D>& p, const PairList& pairs, PairOperator<D>& op) {
  std::atomic<Index> singular{p.n};
#pragma omp parallel for schedule(dynamic, 512)
  for (Index a = 0; a < p.n; ++a) {
    Mat<D> moment = Mat<D>::Zero();
    double scale = 0;
    pairs.for_each(a, [&](Index b, std::int64_t k, int lane) {
      const Vec<D> g = op.vector(k, lane);
      const Vec<D> X = p.X.template vec<D>(b) - p.X.template vec<D>(a);
      moment += g * X.transpose();
      scale += g.norm() * X.norm();
    });
    // Relative to the size it would have with neighbours all around: 1e-9 of it is rank deficiency in single precision.
    if (!(std::abs(moment.determinant()) > 1e-7 * std::pow(scale / D, D))) {
      Index seen = singular.load();
      while (a < seen && !singular.compare_exchange_weak(seen, a)) {
      }
      continue;
    }
    op.M.template set_mat<D>(a, moment.inverse());
  }
  if (singular.load() < p.n) throw_singular(p, pairs, singular.load());
}

}  // namespace

std::vector<std::string> operator_names() { return {"standard", "corrected", "compatible"}; }

namespace {
AlignedArray<float> rounded(const AlignedArray<double>& values) {
  AlignedArray<float> out(values.size());
  std::transform(values.begin(), values.end(), out.begin(), [](double v) { return static_cast<float>(v); });
  return out;
}
}  // namespace

template <int D>
PairOperator<D> make_operator(const Method& method, const Particles<D>& p, const PairList& pairs, const Kernel& kernel,
                              double h) {
  const std::string& name = method.operators;
  const auto names = operator_names();
  if (std::find(names.begin(), names.end(), name) == names.end())
    throw InputError(fmt::format("unknown operators \"{}\"; valid: {}", name, join_names(names)));
  const bool single = method.pair_precision == PairPrecision::single_precision, compatible = name == "compatible";
  PairOperator<D> op;
  op.M = Field(static_cast<std::size_t>(p.total), D * D);
  op.precision = single && !compatible ? PairPrecision::single_precision : PairPrecision::double_precision;
  if (op.precision == PairPrecision::single_precision)
    fill_vectors(p, pairs, kernel, h, op.vectors_f);
  else
    fill_vectors(p, pairs, kernel, h, op.vectors_d);
  if (name == "standard")
    leave_uncorrected(p, pairs, op);
  else
    correct(p, pairs, op);
  if (compatible) {
    make_compatible(p, pairs, kernel, h, method.compatible_iterations, op);
    if (single) {
      op.vectors_f = rounded(std::exchange(op.vectors_d, {}));
      op.adjoint_f = rounded(std::exchange(op.adjoint_d, {}));
      op.precision = PairPrecision::single_precision;
    }
    correct(p, pairs, op);  // linear exactness of the vectors as stored
  }

  op.sum = Field(static_cast<std::size_t>(p.total), D);
#pragma omp parallel for schedule(dynamic, 512)
  for (Index a = 0; a < p.n; ++a) {
    Vec<D> sum = Vec<D>::Zero();
    pairs.for_each(a, [&](Index, std::int64_t k, int lane) { sum += op.vector(k, lane); });
    op.sum.template set_vec<D>(a, sum);
  }
  return op;
}

#define TAUT_INSTANTIATE(D)                                                                                          \
  template PairOperator<D> make_operator<D>(const Method&, const Particles<D>&, const PairList&, const Kernel&, \
                                            double);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
