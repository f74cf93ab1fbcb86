#pragma once
/// \file
/// Small dense systems, up to ten unknowns, written out once. Eigen's solvers of fixed size are compiled
/// anew, with matrix products for large matrices, for every size and in every file: 10 to 20 seconds each.

#include <array>
#include <taut/base/types.hpp>

namespace taut {

namespace detail {
// Matrices of n x n, column by column; `A` is overwritten.
void symmetric_eigen(int n, double* A, double* values, double* vectors);
void right_singular(int n, double* A, double* values, double* vectors);
bool solve(int n, double* A, int columns, double* B);
void factor_ldlt(int n, double* A, int* order);
void solve_ldlt(int n, const double* factors, const int* order, int columns, double* B);
}  // namespace detail

/// Values and, in the columns, the unit vectors that belong to them.
template <int N>
struct Spectrum {
  Fixed<N, 1> values;
  Fixed<N> vectors;
};

/// Eigenvalues, in ascending order, and orthonormal eigenvectors of a symmetric matrix, of which the lower
/// triangle is read. By Jacobi's rotations: vectors are orthogonal to round-off where eigenvalues are equal,
/// too. What is not finite gives what is not finite.
template <int N>
Spectrum<N> symmetric_eigen(Fixed<N> A) {
  Spectrum<N> s;
  detail::symmetric_eigen(N, A.data(), s.values.data(), s.vectors.data());
  return s;
}

/// Singular values, in descending order, and right singular vectors V: A V has orthogonal columns of these
/// lengths. By rotations of columns (Hestenes's one-sided form of Jacobi's method). Vectors of zero values
/// complete the basis.
template <int N>
Spectrum<N> right_singular(Fixed<N> A) {
  Spectrum<N> s;
  detail::right_singular(N, A.data(), s.values.data(), s.vectors.data());
  return s;
}

/// B becomes A^-1 B, by elimination with full pivoting. False, with B undefined, where a pivot is not above N
/// round-offs of the largest: A is singular, or not finite.
template <int N, int Columns>
bool solve_small(Fixed<N> A, Fixed<N, Columns>& B) {
  return detail::solve(N, A.data(), Columns, B.data());
}

/// L D L^T of a symmetric matrix, of which the lower triangle is read, with the largest diagonal entry that
/// is left as the next pivot.
template <int N>
class SmallLdlt {
 public:
  explicit SmallLdlt(const Fixed<N>& A) : factors_(A) {
    detail::factor_ldlt(N, factors_.data(), order_.data());
  }

  /// The smallest entry of D; negative where A is indefinite, not a number where A is not finite.
  double least_pivot() const {
    double least = factors_(0, 0);
    for (int k = 1; k < N; ++k)
      if (!(least < factors_(k, k))) least = factors_(k, k);
    return least;
  }

  /// A^-1 B; every pivot must differ from zero.
  template <int Columns>
  Fixed<N, Columns> solve(Fixed<N, Columns> B) const {
    detail::solve_ldlt(N, factors_.data(), order_.data(), Columns, B.data());
    return B;
  }

 private:
  Fixed<N> factors_;
  std::array<int, N> order_;
};

}  // namespace taut
