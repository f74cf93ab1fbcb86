#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <numeric>
#include <taut/core/error.hpp>
#include <taut/internal/compatible_operator.hpp>

namespace taut {

namespace {

/// The Schur complement for lambda, and what turns its solution into pair vectors.
template <int D>
class ClosureSystem {
 public:
  ClosureSystem(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h, const PairOperator<D>& op)
      : p_(p), pairs_(pairs), op_(op), moments_(size(), D * D), mu_(size(), D * D), first_moment_(size(), D) {
    weight_ = AlignedArray<double>(static_cast<std::size_t>(pairs.slots()) * lanes);
    const double top = kernel.value(0, h);
#pragma omp parallel for schedule(dynamic, 512)
    for (Index a = 0; a < p.n; ++a) {
      Mat<D> A = Mat<D>::Zero();
      Vec<D> m = Vec<D>::Zero();
      each_pair(a, [&](Index b, std::int64_t k, int lane, const Vec<D>& X) {
        const double w = kernel.value(X.norm(), h) / top;
        weight_[static_cast<std::size_t>(k * lanes + lane)] = w * w;
        (void)b;
        A += w * w * X * X.transpose();
        m += w * w * X;
      });
      moments_.template set_mat<D>(a, A.inverse());
      first_moment_.template set_vec<D>(a, m);
    }
    p.mirror.tensors(moments_);
  }

  std::size_t size() const { return static_cast<std::size_t>(p_.total); }

  /// mu of all particles for the given lambda.
  void update_mu(Field& lambda) {
    p_.mirror.vectors(lambda);
#pragma omp parallel for schedule(static)
    for (Index a = 0; a < p_.n; ++a) {
      const Vec<D> la = lambda.template vec<D>(a);
      Mat<D> sum = Mat<D>::Zero();
      each_pair(a, [&](Index b, std::int64_t k, int lane, const Vec<D>& X) {
        sum += weight(k, lane) * (la - lambda.template vec<D>(b)) * X.transpose();
      });
      mu_.template set_mat<D>(a, -sum * moments_.template mat<D>(a));
    }
    p_.mirror.tensors(mu_);
  }

  /// out = S lambda.
  void apply(Field& lambda, Field& out) {
    update_mu(lambda);
#pragma omp parallel for schedule(static)
    for (Index a = 0; a < p_.n; ++a) {
      const Vec<D> la = lambda.template vec<D>(a);
      const Mat<D> mu = mu_.template mat<D>(a);
      Vec<D> sum = Vec<D>::Zero();
      each_pair(a, [&](Index b, std::int64_t k, int lane, const Vec<D>& X) {
        sum += weight(k, lane) * ((mu + mu_.template mat<D>(b)) * X + 2 * (la - lambda.template vec<D>(b)));
      });
      out.template set_vec<D>(a, sum);
    }
  }

  /// The diagonal of S, one value a particle.
  Field diagonal() const {
    Field d(size(), 1);
#pragma omp parallel for schedule(static)
    for (Index a = 0; a < p_.n; ++a) {
      const Vec<D> m = first_moment_.template vec<D>(a);
      double sum = -m.dot(moments_.template mat<D>(a) * m);
      each_pair(a, [&](Index b, std::int64_t k, int lane, const Vec<D>& X) {
        const double w = weight(k, lane);
        sum += 2 * w - w * w * X.dot(moments_.template mat<D>(b) * X);
      });
      d.component(0)[a] = sum;
    }
    return d;
  }

  /// V_a K_a V_b grad W_ab + w^2 (mu_a X_ab + lambda_a - lambda_b), with the matrices of `of`: a itself for G_ab, b for
  /// -G_ba. One function for both, so that they are the same numbers bit for bit.
  [[gnu::noinline]] Vec<D> vector(Index of, std::int64_t k, int lane, const Vec<D>& X, const Vec<D>& difference) const {
    return p_.V.component(0)[of] * (op_.M.template mat<D>(of) * op_.vector(k, lane)) +
           weight(k, lane) * (mu_.template mat<D>(of) * X + difference);
  }

  template <class F>
  void each_pair(Index a, F&& f) const {
    const Vec<D> Xa = p_.X.template vec<D>(a);
    pairs_.for_each(a, [&](Index b, std::int64_t k, int lane) { f(b, k, lane, p_.X.template vec<D>(b) - Xa); });
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
  double weight(std::int64_t k, int lane) const { return weight_[static_cast<std::size_t>(k * lanes + lane)]; }

  const Particles<D>& p_;
  const PairList& pairs_;
  const PairOperator<D>& op_;
  AlignedArray<double> weight_;
  Field moments_, mu_, first_moment_;
};

template <int D>
double dot(const Particles<D>& p, const Field& x, const Field& y) {
  double sum = 0;
  for (int d = 0; d < D; ++d)
    for (Index i = 0; i < p.n; ++i) sum += x.component(d)[i] * y.component(d)[i];
  return sum;
}

/// The system has a solution only if the areas close: sum B = 0.
template <int D>
void check_areas(const Particles<D>& p) {
  if (p.B.empty())
    throw InputError("compatible operators need boundary area vectors: use a node-centred lattice, or a CSV cloud with columns bx, by, bz");
  if (!p.mirror.empty()) return;  // the other half closes what this one leaves open
  Vec<D> sum = Vec<D>::Zero();
  double total = 0;
  for (const Vec<D>& B : p.B) {
    sum += B;
    total += B.norm();
  }
  if (sum.norm() > 1e-9 * total)
    throw InputError(fmt::format("compatible operators: the boundary area vectors sum to {:g} of their total instead of 0", sum.norm() / total));
}

}  // namespace

template <int D>
double make_compatible(const Particles<D>& p, const PairList& pairs, const Kernel& kernel, double h, int iterations,
                       PairOperator<D>& op) {
  check_areas(p);
  p.mirror.tensors(op.M);
  ClosureSystem<D> system(p, pairs, kernel, h, op);

  // Preconditioned conjugate gradients; the D components are D independent systems taken as one.
  Field lambda(system.size(), D), residual = system.closure_defect(), direction(system.size(), D), image(system.size(), D),
        preconditioned(system.size(), D);
  const Field diagonal = system.diagonal();
  const double before = std::sqrt(dot(p, residual, residual));
  // What iterates on the round-off of vectors that close already diverges.
  const double* V = p.V.component(0);
  const double round_off = 1e-14 / p.dx * std::sqrt(std::inner_product(V, V + p.n, V, 0.0));
  double rho = 0;
  for (int it = 0; it < iterations && before > 0; ++it) {
    for (int d = 0; d < D; ++d)
      for (Index i = 0; i < p.n; ++i)
        preconditioned.component(d)[i] = residual.component(d)[i] / std::max(diagonal.component(0)[i], 1e-300);
    const double next = dot(p, residual, preconditioned);
    const double enough = std::max(1e-14 * before, round_off);
    if (!(next > enough * enough / diagonal.component(0)[0])) break;
    const double beta = it == 0 ? 0 : next / rho;
    rho = next;
    for (int d = 0; d < D; ++d)
      for (Index i = 0; i < p.n; ++i)
        direction.component(d)[i] = preconditioned.component(d)[i] + beta * direction.component(d)[i];
    system.apply(direction, image);
    const double alpha = rho / dot(p, direction, image);
    if (!std::isfinite(alpha)) break;
    for (int d = 0; d < D; ++d)
      for (Index i = 0; i < p.n; ++i) {
        lambda.component(d)[i] += alpha * direction.component(d)[i];
        residual.component(d)[i] -= alpha * image.component(d)[i];
      }
  }
  system.update_mu(lambda);

  AlignedArray<double> own(op.vectors_d.size()), adjoint(op.vectors_d.size());
#pragma omp parallel for schedule(dynamic, 512)
  for (Index a = 0; a < p.total; ++a) {
    const Vec<D> la = lambda.template vec<D>(a);
    system.each_pair(a, [&](Index b, std::int64_t k, int lane, const Vec<D>& X) {
      const Vec<D> difference = la - lambda.template vec<D>(b);
      const Vec<D> g = system.vector(a, k, lane, X, difference), minus_g_ba = system.vector(b, k, lane, X, difference);
      for (int d = 0; d < D; ++d) {
        const auto at = static_cast<std::size_t>((k * D + d) * lanes + lane);
        own[at] = g[d];
        adjoint[at] = minus_g_ba[d];
      }
    });
  }
  op.vectors_d = std::move(own);
  op.adjoint_d = std::move(adjoint);
  return before > 0 ? std::sqrt(dot(p, residual, residual)) / before : 0;
}

template double make_compatible<1>(const Particles<1>&, const PairList&, const Kernel&, double, int, PairOperator<1>&);
template double make_compatible<2>(const Particles<2>&, const PairList&, const Kernel&, double, int, PairOperator<2>&);
template double make_compatible<3>(const Particles<3>&, const PairList&, const Kernel&, double, int, PairOperator<3>&);

}  // namespace taut
