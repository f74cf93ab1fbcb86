#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/base/small_solve.hpp>
#include <taut/operators/operator_entries.hpp>
#include <taut/operators/operator_parts.hpp>
#include <taut/operators/quadratic_operator.hpp>

namespace taut {

namespace {

/// Smallest pivot of the normal matrix, of unit diagonal, below which its neighbours count as too few. Those
/// that do not determine a quadratic leave round-off, 1e-16; a lattice at R = 2.1 dx, whose second
/// neighbours hardly weigh, leaves 1e-5.
constexpr double least_pivot = 1e-10;

/// Largest sum_b |X_ab| |G_ab| / V_a: a lattice has less than 10, while neighbours that hardly determine a
/// quadratic get huge vectors of either sign, which no motion is followed with.
constexpr double largest_sum = 100;

template <int D>
class QuadraticFit {
 public:
  static constexpr int terms = D + D * (D + 1) / 2;

  QuadraticFit(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h)
      : p_(p),
        kernel_(kernel),
        h_(h),
        top_(kernel.value(0, h)),
        coefficients_(static_cast<std::size_t>(p.n)),
        signs_(p.mirror.empty() ? 0 : static_cast<std::size_t>(p.total), D) {
    std::atomic<Index> singular{p.n};
    parallel_for_dynamic(p.n, 512, true, [&](Index a) {
      if (fit(a, pairs)) return;
      Index seen = singular.load();
      while (a < seen && !singular.compare_exchange_weak(seen, a)) {
      }
    });
    if (singular.load() < p.n) throw_singular(singular.load(), pairs);
    if (!p.mirror.empty()) {
      std::fill(signs_.flat().begin(), signs_.flat().end(), 1.0);
      p.mirror.vectors(signs_);
    }
  }

  /// G of particle `of`, for its neighbour at distance X. One function for G_ab and G_ba, seen from a and
  /// from b, so that they are the same numbers bit for bit.
  [[gnu::noinline]] Vec<D> vector(Index of, const Vec<D>& X) const {
    const double VW = p_.V.component(0)[of] * weight(X);
    if (of < p_.n) return VW * (coefficients_[static_cast<std::size_t>(of)] * monomials(X));
    // An image sees what its master sees, reflected.
    const Vec<D> sign = signs_.template vec<D>(of);
    const auto master = static_cast<std::size_t>(p_.mirror.master(of - p_.mirror.begin()));
    return VW * sign.cwiseProduct(coefficients_[master] * monomials(Vec<D>(sign.cwiseProduct(X))));
  }

 private:
  using Terms = Fixed<terms, 1>;

  Terms monomials(const Vec<D>& X) const {
    const Vec<D> s = X / p_.dx;
    Terms t;
    t.template head<D>() = s;
    for (int i = 0, k = D; i < D; ++i)
      for (int j = i; j < D; ++j) t[k++] = s[i] * s[j];
    return t;
  }
  double weight(const Vec<D>& X) const { return kernel_.value(X.norm(), h_) / top_; }

  /// False where the neighbours of a do not determine a quadratic, or hardly.
  bool fit(Index a, const PairList& pairs) {
    Fixed<terms> normal = Fixed<terms>::Zero();
    const Vec<D> Xa = p_.X.template vec<D>(a);
    pairs.for_each(a, [&](Index b, std::int64_t, int) {
      const Vec<D> X = p_.X.template vec<D>(b) - Xa;
      const Terms t = monomials(X);
      normal += weight(X) * t * t.transpose();
    });
    if (!(normal.diagonal().minCoeff() > 0)) return false;
    const Terms scale = normal.diagonal().cwiseSqrt().cwiseInverse();
    normal = scale.asDiagonal() * normal * scale.asDiagonal();
    const SmallLdlt<terms> factors(normal);
    if (!(factors.least_pivot() > least_pivot)) return false;
    using Columns = Fixed<terms, D>;
    const Columns unit = Columns::Identity();
    Columns columns = factors.solve(unit);
    columns +=
        factors.solve(Columns(unit - normal.lazyProduct(columns)));  // what a pivot of 1e-5 costs in digits
    auto& C = coefficients_[static_cast<std::size_t>(a)];
    C = (scale.asDiagonal() * columns * scale.template head<D>().asDiagonal()).transpose() / p_.dx;
    double sum = 0;
    pairs.for_each(a, [&](Index b, std::int64_t, int) {
      const Vec<D> X = p_.X.template vec<D>(b) - Xa;
      sum += weight(X) * X.norm() * (C * monomials(X)).norm();
    });
    return sum < largest_sum;
  }

  [[noreturn]] void throw_singular(Index a, const PairList& pairs) const {
    Index neighbours = 0;
    pairs.for_each(a, [&](Index, std::int64_t, int) { ++neighbours; });
    throw InputError(fmt::format(
        "quadratic operator: the {} neighbour(s) of particle {} at {} do not determine a quadratic "
        "in {} dimension(s), which takes {} in general position. Enlarge support_dx (2.4 does on "
        "lattices), refine dx, or thicken the body there",
        neighbours, p_.id[static_cast<std::size_t>(a)], describe<D>(p_.reference_position(a)), D,
        static_cast<int>(terms)));
  }

  const Particles<D>& p_;
  const Kernel& kernel_;
  double h_, top_;
  std::vector<Fixed<D, terms>> coefficients_;
  Field signs_;  // of the reflections that images are; empty without images
};

}  // namespace

template <int D>
void make_quadratic(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h,
                    PairOperator<D>& op) {
  const QuadraticFit<D> fit(p, pairs, kernel, h);
  store_pair_vectors(
      p, pairs,
      [&](Index a, Index b, std::int64_t, int, const Vec<D>& X) {
        return std::pair<Vec<D>, Vec<D>>(fit.vector(a, X), -fit.vector(b, -X));
      },
      op);
}

namespace {

template <int D>
PairOperator<D> make(const OperatorSetup<D>& setup) {
  PairOperator<D> op = start_operator(setup, false);
  if (!setup.particles.spacing.empty())
    throw InputError(
        "quadratic operators have one support for all particles, which this cloud is too graded for: use "
        "compatible operators");
  make_quadratic(setup.particles, setup.pairs, setup.kernel, setup.smoothing_length, op);
  make_matrices(setup, true, op);
  return op;
}

}  // namespace

OperatorEntry quadratic_entry() {
  return {
      .name = "quadratic",
      .line =
          "gradients of quadratic fields exact; does not close, so that it does not converge on irregular "
          "clouds; takes `support_dx` from about 2.1",
      .make = {make<1>, make<2>, make<3>},
      .traits = {.exact = 2, .adjoint = true, .support_dx = 2.4}};
}

template void make_quadratic<1>(const Particles<1>&, const PairList&, const Kernel&, double,
                                PairOperator<1>&);
template void make_quadratic<2>(const Particles<2>&, const PairList&, const Kernel&, double,
                                PairOperator<2>&);
template void make_quadratic<3>(const Particles<3>&, const PairList&, const Kernel&, double,
                                PairOperator<3>&);

}  // namespace taut
