#pragma once
/// \file
/// The linear system that closes pair vectors by the least change.

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/base/powers.hpp>
#include <taut/integrators/vector_ops.hpp>
#include <taut/operators/operators.hpp>
#include <taut/operators/pair_payload.hpp>
#include <taut/particles/particles.hpp>
#include <utility>

namespace taut {

/// The Schur complement for the multipliers lambda of the closure, see `make_compatible`, for an operator in
/// factored form with stored vectors: G_ab = V_a M_a g_ab.
template <int D>
class ClosureSystem {
 public:
  ClosureSystem(const Particles<D>& p, const PairList& pairs, const PairOperator<D>& op)
      : p_(p), pairs_(pairs), op_(op), moments_(size(), D * D), mu_(size(), D * D), first_moment_(size(), D) {
#pragma omp parallel for schedule(dynamic, 512)
    for (Index a = 0; a < p.n; ++a) {
      Mat<D> A = Mat<D>::Zero();
      Vec<D> m = Vec<D>::Zero();
      each_pair(a, [&](Index, std::int64_t, int, const Vec<D>& X) {
        A += X * X.transpose();
        m += X;
      });
      moments_.template set_mat<D>(a, A.inverse());
      first_moment_.template set_vec<D>(a, m);
    }
    p.mirror.tensors(moments_);
    inverse_diagonal_ = inverse_diagonal();
  }

  std::size_t size() const { return static_cast<std::size_t>(p_.total); }

  /// mu of all particles for the given lambda.
  void update_mu(Field& lambda) {
    p_.mirror.vectors(lambda);
    const Columns<D> X(p_.X), l(lambda);
    const Columns<D * D> inverse(moments_);
#pragma omp parallel for schedule(static)
    for (Index s = 0; s < pairs_.slices(); ++s) {
      Pack sum[D * D];
      for (auto& c : sum) c = pack(0);
      each_slot(s, X, l, [&](auto&&, const Pack(&X_ab)[D], const Pack(&difference)[D]) TAUT_INLINE_LAMBDA {
        for (int d = 0; d < D; ++d)
          for (int e = 0; e < D; ++e) sum[d * D + e] -= difference[d] * X_ab[e];
      });
      for (int d = 0; d < D; ++d)
        for (int e = 0; e < D; ++e) {
          Pack m = sum[d * D] * load(inverse.c[e] + s * lanes);
          for (int j = 1; j < D; ++j) m += sum[d * D + j] * load(inverse.c[j * D + e] + s * lanes);
          store(mu_.component(d * D + e) + s * lanes, m);
        }
    }
    p_.mirror.tensors(mu_);
  }

  /// out = S lambda.
  void apply(Field& lambda, Field& out) {
    update_mu(lambda);
    const Columns<D> X(p_.X), l(lambda), first(first_moment_);
    const Columns<D * D> mu(mu_);
#pragma omp parallel for schedule(static)
    for (Index s = 0; s < pairs_.slices(); ++s) {
      Pack sum[D];
      for (int d = 0; d < D; ++d) {
        sum[d] = load(mu.c[d * D] + s * lanes) * load(first.c[0] + s * lanes);
        for (int e = 1; e < D; ++e)
          sum[d] += load(mu.c[d * D + e] + s * lanes) * load(first.c[e] + s * lanes);
      }
      each_slot(s, X, l, [&](auto&& at, const Pack(&X_ab)[D], const Pack(&difference)[D]) TAUT_INLINE_LAMBDA {
        for (int d = 0; d < D; ++d) {
          sum[d] += 2 * difference[d];
          for (int e = 0; e < D; ++e) sum[d] += at(mu.c[d * D + e]) * X_ab[e];
        }
      });
      for (int d = 0; d < D; ++d) store(out.component(d) + s * lanes, sum[d]);
    }
    // Mirror images follow their masters: they have no equations of their own.
    for (int d = 0; d < D; ++d) std::fill(out.component(d) + p_.n, out.component(d) + p_.total, 0.0);
  }

  /// One over the diagonal of S, for each component of lambda.
  Field inverse_diagonal() const {
    Field inverse(size(), D);
#pragma omp parallel for schedule(static)
    for (Index a = 0; a < p_.n; ++a) {
      const Vec<D> m = first_moment_.template vec<D>(a);
      double sum = -m.dot(moments_.template mat<D>(a) * m);
      each_pair(a, [&](Index b, std::int64_t, int, const Vec<D>& X) {
        sum += 2 - X.dot(moments_.template mat<D>(b) * X);
      });
      for (int d = 0; d < D; ++d) inverse.component(d)[a] = sum > 0 ? 1 / sum : 0;
    }
    return inverse;
  }

  /// lambda after some iterations of preconditioned conjugate gradients, with `update_mu` done for it, and
  /// |closure residual| / |closure residual before|. The D components are D independent systems taken as one.
  std::pair<Field, double> solve(int iterations) {
    // Residuals and images are zero beyond the bodies' particles, so sums may run over whole fields.
    Field lambda(size(), D), residual = closure_defect(), direction(size(), D), image(size(), D);
    const double before = std::sqrt(dot(residual.flat(), residual.flat()));
    // Round-off of the closure of a cell's faces: below it there is nothing to solve for.
    const double negligible = 1e-14 * int_power(p_.dx, D - 1) * std::sqrt(static_cast<double>(p_.n));
    double rho = 0, now = before;
    for (int it = 0; it < iterations && now > negligible; ++it) {
      const double next = weighted_dot(inverse_diagonal_.flat(), residual.flat(), residual.flat());
      const double beta = it == 0 ? 0 : next / rho;
      rho = next;
      const auto values = static_cast<std::int64_t>(direction.flat().size());
#pragma omp parallel for simd schedule(static)
      for (std::int64_t i = 0; i < values; ++i)
        direction.data()[i] = inverse_diagonal_.data()[i] * residual.data()[i] + beta * direction.data()[i];
      apply(direction, image);
      const double alpha = rho / dot(direction.flat(), image.flat());
      if (!std::isfinite(alpha)) break;
      add_scaled(lambda.flat(), alpha, direction.flat());
      add_scaled(residual.flat(), -alpha, image.flat());
      now = std::sqrt(dot(residual.flat(), residual.flat()));
    }
    update_mu(lambda);
    return {std::move(lambda), before > negligible ? now / before : 0};
  }
  Mat<D> mu(Index a) const { return mu_.template mat<D>(a); }

  /// f(at, X_ab, lambda_a - lambda_b) for each slot of a slice, both zero where it has no pair.
  template <class F>
  TAUT_INLINE void each_slot(Index s, const Columns<D>& X, const Columns<D>& lambda, F&& f) const {
    Pack Xa[D], la[D];
    for (int d = 0; d < D; ++d) {
      Xa[d] = load(X.c[d] + s * lanes);
      la[d] = load(lambda.c[d] + s * lanes);
    }
    for_slots(pairs_, s, [&](std::int64_t k, auto&& at) TAUT_INLINE_LAMBDA {
      const PackMask pair = lanes_of(pairs_.mask(k));
      Pack X_ab[D], difference[D];
      for (int d = 0; d < D; ++d) {
        X_ab[d] = pair ? at(X.c[d]) - Xa[d] : pack(0);
        difference[d] = pair ? la[d] - at(lambda.c[d]) : pack(0);
      }
      f(at, X_ab, difference);
    });
  }

  template <class F>
  void each_pair(Index a, F&& f) const {
    const Vec<D> Xa = p_.X.template vec<D>(a);
    pairs_.for_each(a,
                    [&](Index b, std::int64_t k, int lane) { f(b, k, lane, p_.X.template vec<D>(b) - Xa); });
  }

  /// -B_a - sum_b (G_ab - G_ba) of the operator as it came.
  Field closure_defect() const {
    Field defect(size(), D);
#pragma omp parallel for schedule(static)
    for (Index a = 0; a < p_.n; ++a) {
      Vec<D> sum = -p_.B[static_cast<std::size_t>(a)];
      const Mat<D> own = p_.V.component(0)[a] * op_.M.template mat<D>(a);
      pairs_.for_each(a, [&](Index b, std::int64_t k, int lane) {
        sum -= (own + p_.V.component(0)[b] * op_.M.template mat<D>(b)) * op_.vector(k, lane);
      });
      defect.template set_vec<D>(a, sum);
    }
    return defect;
  }

 private:
  const Particles<D>& p_;
  const PairList& pairs_;
  const PairOperator<D>& op_;
  Field moments_, mu_, first_moment_, inverse_diagonal_;
};

/// The system has a solution only if the areas close: sum B = 0.
template <int D>
void check_areas(const Particles<D>& p) {
  if (p.B.empty())
    throw InputError(
        "compatible and antisymmetric operators need boundary area vectors: use a node-centred lattice, or a "
        "CSV cloud with "
        "columns bx, by, bz");
  if (!p.mirror.empty()) return;  // the other half closes what this one leaves open
  Vec<D> sum = Vec<D>::Zero();
  double total = 0;
  for (const Vec<D>& B : p.B) {
    sum += B;
    total += B.norm();
  }
  if (sum.norm() > 1e-9 * total)
    throw InputError(
        fmt::format("the boundary area vectors sum to {:g} of their total instead of 0", sum.norm() / total));
}

}  // namespace taut
