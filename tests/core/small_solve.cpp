// Small dense systems: what the solvers promise, on random, degenerate and singular matrices.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <taut/base/small_solve.hpp>

using namespace taut;

namespace {

template <int N, int Columns = N>
Fixed<N, Columns> random_matrix(std::mt19937& random) {
  Fixed<N, Columns> A;
  for (int i = 0; i < A.size(); ++i) A.data()[i] = random() / 2147483648.0 - 1;
  return A;
}

template <int N>
void check_eigen(const Fixed<N>& A) {
  const Spectrum<N> s = symmetric_eigen<N>(A);
  CAPTURE(A);
  CHECK((s.vectors.transpose() * s.vectors - Fixed<N>::Identity()).norm() < 1e-14);
  CHECK((A * s.vectors - s.vectors * s.values.asDiagonal()).norm() <= 4e-15 * A.norm());
  for (int k = 1; k < N; ++k) CHECK(s.values[k - 1] <= s.values[k]);
}

template <int N>
void check_singular(const Fixed<N>& A) {
  const Spectrum<N> s = right_singular<N>(A);
  CAPTURE(A);
  CHECK((s.vectors.transpose() * s.vectors - Fixed<N>::Identity()).norm() < 1e-14);
  const Fixed<N> lengths = s.values.cwiseAbs2().asDiagonal();
  const Fixed<N> columns = A * s.vectors;
  CHECK((columns.transpose() * columns - lengths).norm() <= 1e-14 * A.squaredNorm());
  for (int k = 1; k < N; ++k) CHECK(s.values[k - 1] >= s.values[k]);
}

template <int N>
void check_solvers(std::mt19937& random) {
  CAPTURE(N);
  const Fixed<N> A = random_matrix<N>(random);
  const Fixed<N, 2> x = random_matrix<N, 2>(random);
  Fixed<N, 2> b = A * x;
  REQUIRE(solve_small(A, b));
  CHECK((b - x).norm() < 1e-12 * x.norm());

  const Fixed<N> positive = A * A.transpose() + 0.1 * Fixed<N>::Identity();
  const SmallLdlt<N> factors(positive);
  CHECK(factors.least_pivot() > 0);
  CHECK(factors.least_pivot() <= positive.diagonal().minCoeff() * (1 + 1e-14));
  CHECK((factors.solve(Fixed<N, 2>(positive * x)) - x).norm() < 1e-12 * x.norm());
}

}  // namespace

TEST_CASE("eigenvectors of small symmetric matrices, with equal and zero eigenvalues too") {
  std::mt19937 random(1);
  for (int k = 0; k < 50; ++k) {
    check_eigen<1>(random_matrix<1>(random));
    const Fixed<2> A = random_matrix<2>(random);
    check_eigen<2>(A + A.transpose());
    const Fixed<3> B = random_matrix<3>(random);
    check_eigen<3>(B + B.transpose());
    // Two or all equal; one or two zero.
    const Fixed<3, 1> a = random_matrix<3, 1>(random), b = random_matrix<3, 1>(random);
    const Fixed<3> plane = a * a.transpose();
    check_eigen<3>(plane);
    check_eigen<3>(plane + b * b.transpose());
    check_eigen<3>(plane + Fixed<3>::Identity());
    check_eigen<3>(2 * Fixed<3>::Identity() + 1e-13 * (B + B.transpose()));
    check_eigen<3>(1e-160 * plane);
  }
  check_eigen<3>(Fixed<3>::Zero());
  check_eigen<2>(Fixed<2>::Ones());
  Fixed<2> swap;
  swap << 0, 1, 1, 0;
  const Spectrum<2> s = symmetric_eigen<2>(swap);
  CHECK(s.values[0] == doctest::Approx(-1).epsilon(1e-15));
  CHECK(s.values[1] == doctest::Approx(1).epsilon(1e-15));
}

TEST_CASE("small eigenvalues pass through a change of units by powers of two") {
  std::mt19937 random(2);
  const Fixed<3> A = random_matrix<3>(random), symmetric = A + A.transpose();
  const Spectrum<3> one = symmetric_eigen<3>(symmetric), other = symmetric_eigen<3>(0x1p40 * symmetric);
  CHECK(other.values == 0x1p40 * one.values);
  CHECK(other.vectors == one.vectors);
}

TEST_CASE("eigenvalues of what is not finite are not finite") {
  Fixed<3> A = Fixed<3>::Identity();
  A(1, 0) = A(0, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK(!symmetric_eigen<3>(A).values.allFinite());
}

TEST_CASE("singular vectors of small matrices, of any rank") {
  std::mt19937 random(3);
  for (int k = 0; k < 50; ++k) {
    check_singular<1>(random_matrix<1>(random));
    check_singular<3>(random_matrix<3>(random));
    const Fixed<6> A = random_matrix<6>(random);
    check_singular<6>(A);
    check_singular<6>(A.triangularView<Eigen::Upper>());
    Fixed<6> flat = A;
    flat.col(4) = flat.col(0) - 2 * flat.col(3);
    flat.col(2).setZero();
    check_singular<6>(flat);
    const Spectrum<6> s = right_singular<6>(flat);
    CHECK(s.values[3] > 1e-3);
    CHECK(s.values[4] < 1e-15 * s.values[0]);
    CHECK((flat * s.vectors.rightCols<2>()).norm() < 1e-14);
    CHECK((flat * flat.transpose()).trace() == doctest::Approx(s.values.squaredNorm()).epsilon(1e-13));
  }
  // Values far below those of the normal matrix's round-off.
  Fixed<2> graded;
  graded << 1, 1, 0, 1e-9;
  CHECK(right_singular<2>(graded).values[1] == doctest::Approx(1e-9 / std::sqrt(2)).epsilon(1e-6));
  check_singular<3>(Fixed<3>::Zero());
}

TEST_CASE("small systems are solved, or found singular") {
  std::mt19937 random(4);
  for (int k = 0; k < 50; ++k) {
    check_solvers<1>(random);
    check_solvers<2>(random);
    check_solvers<3>(random);
    check_solvers<4>(random);
    check_solvers<5>(random);
    check_solvers<9>(random);
  }
  Fixed<3> A;
  A << 0, 0, 2, 3, 0, 0, 0, 5, 0;  // a permutation: no pivot on the diagonal
  Fixed<3, 1> x(2, 3, 5);
  REQUIRE(solve_small(A, x));
  CHECK(x == Fixed<3, 1>(1, 1, 1));

  Fixed<4> flat = random_matrix<4>(random);
  flat.row(3) = flat.row(0) + flat.row(1);
  Fixed<4, 1> right = Fixed<4, 1>::Ones();
  CHECK(!solve_small(flat, right));
  CHECK(!solve_small(Fixed<4>::Zero().eval(), right));
  flat.setIdentity();
  flat(2, 2) = std::numeric_limits<double>::quiet_NaN();
  CHECK(!solve_small(flat, right));
}

TEST_CASE("pivots tell matrices that are not positive definite") {
  Fixed<2> A;
  A << 0, 1, 1, 0;
  CHECK(!(SmallLdlt<2>(A).least_pivot() > 0));
  A << 1, 2, 2, 1;
  CHECK(SmallLdlt<2>(A).least_pivot() == doctest::Approx(-3));
  A << 1, 1, 1, 1;
  CHECK(SmallLdlt<2>(A).least_pivot() == 0);
  A(1, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK(!(SmallLdlt<2>(A).least_pivot() > 0));
}
