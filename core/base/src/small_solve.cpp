#include <algorithm>
#include <cmath>
#include <limits>
#include <taut/base/small_solve.hpp>

namespace taut::detail {
namespace {

constexpr double rounding = std::numeric_limits<double>::epsilon();
constexpr int most_sweeps = 60;  // some six are needed; what is not finite ends here

struct Rotation {
  double c, s, t;
  // Of the plane in which a symmetric matrix has diagonal p, q and off-diagonal entry `off`, which it
  // removes.
  Rotation(double p, double q, double off) {
    const double theta = (q - p) / (2 * off);
    t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::hypot(1.0, theta));
    c = 1 / std::sqrt(1 + t * t);
    s = t * c;
  }
  void operator()(double& x, double& y) const {
    const double old = x;
    x = c * old - s * y;
    y = s * old + c * y;
  }
};

void set_identity(int n, double* A) {
  std::fill(A, A + n * n, 0.0);
  for (int k = 0; k < n; ++k) A[k * (n + 1)] = 1;
}

// Sweeps over all pairs of columns p < q until `rotate(p, q)` finds none to rotate.
template <class Rotate>
void sweep(int n, Rotate rotate) {
  bool rotated = true;
  for (int k = 0; k < most_sweeps && rotated; ++k) {
    rotated = false;
    for (int p = 0; p < n; ++p)
      for (int q = p + 1; q < n; ++q) rotated = rotate(p, q) || rotated;
  }
}

// By selection, with the columns that belong to the values.
template <class Before>
void sort_columns(int n, double* values, double* vectors, Before before) {
  for (int k = 0; k + 1 < n; ++k) {
    int best = k;
    for (int j = k + 1; j < n; ++j)
      if (before(values[j], values[best])) best = j;
    if (best == k) continue;
    std::swap(values[k], values[best]);
    std::swap_ranges(vectors + k * n, vectors + (k + 1) * n, vectors + best * n);
  }
}

}  // namespace

void symmetric_eigen(int n, double* A, double* values, double* vectors) {
  const auto at = [&](int i, int j) -> double& {
    return A[i >= j ? i + j * n : j + i * n];
  };  // lower triangle
  set_identity(n, vectors);
  sweep(n, [&](int p, int q) {
    const double off = at(q, p), p_p = at(p, p), q_q = at(q, q);
    if (off == 0) return false;
    at(q, p) = 0;
    // Too small to change a digit of either.
    if (std::abs(off) <= 0.01 * rounding * std::min(std::abs(p_p), std::abs(q_q))) return false;
    const Rotation rotation(p_p, q_q, off);
    const double shift = rotation.t * off;
    at(p, p) = p_p - shift;
    at(q, q) = q_q + shift;
    for (int k = 0; k < n; ++k) {
      if (k != p && k != q) rotation(at(k, p), at(k, q));
      rotation(vectors[k + p * n], vectors[k + q * n]);
    }
    return true;
  });
  for (int k = 0; k < n; ++k) values[k] = at(k, k);
  sort_columns(n, values, vectors, [](double x, double y) { return x < y; });
}

void right_singular(int n, double* A, double* values, double* vectors) {
  set_identity(n, vectors);
  sweep(n, [&](int p, int q) {
    double p_p = 0, q_q = 0, off = 0;
    for (int k = 0; k < n; ++k) {
      p_p += A[k + p * n] * A[k + p * n];
      q_q += A[k + q * n] * A[k + q * n];
      off += A[k + p * n] * A[k + q * n];
    }
    if (off == 0 || std::abs(off) <= rounding * std::sqrt(p_p) * std::sqrt(q_q)) return false;
    const Rotation rotation(p_p, q_q, off);
    for (int k = 0; k < n; ++k) {
      rotation(A[k + p * n], A[k + q * n]);
      rotation(vectors[k + p * n], vectors[k + q * n]);
    }
    return true;
  });
  for (int j = 0; j < n; ++j) {
    double square = 0;
    for (int k = 0; k < n; ++k) square += A[k + j * n] * A[k + j * n];
    values[j] = std::sqrt(square);
  }
  sort_columns(n, values, vectors, [](double x, double y) { return x > y; });
}

bool solve(int n, double* A, int columns, double* B) {
  const auto a = [&](int i, int j) -> double& { return A[i + j * n]; };
  int unknown[16];  // which stands in each column
  for (int k = 0; k < n; ++k) unknown[k] = k;
  double largest = 0;
  for (int k = 0; k < n; ++k) {
    int row = k, column = k;
    for (int j = k; j < n; ++j)
      for (int i = k; i < n; ++i)
        if (std::abs(a(i, j)) > std::abs(a(row, column))) row = i, column = j;
    const double size = std::abs(a(row, column));
    largest = std::max(largest, size);
    if (!(size > n * rounding * largest) || !std::isfinite(size)) return false;
    if (row != k) {
      for (int j = 0; j < n; ++j) std::swap(a(k, j), a(row, j));
      for (int j = 0; j < columns; ++j) std::swap(B[k + j * n], B[row + j * n]);
    }
    if (column != k) {
      std::swap_ranges(A + k * n, A + (k + 1) * n, A + column * n);
      std::swap(unknown[k], unknown[column]);
    }
    for (int i = k + 1; i < n; ++i) {
      const double factor = a(i, k) / a(k, k);
      for (int j = k + 1; j < n; ++j) a(i, j) -= factor * a(k, j);
      for (int j = 0; j < columns; ++j) B[i + j * n] -= factor * B[k + j * n];
    }
  }
  double x[16];
  for (int j = 0; j < columns; ++j) {
    double* b = B + j * n;
    for (int k = n - 1; k >= 0; --k) {
      for (int i = k + 1; i < n; ++i) b[k] -= a(k, i) * b[i];
      b[k] /= a(k, k);
    }
    for (int k = 0; k < n; ++k) x[unknown[k]] = b[k];
    std::copy(x, x + n, b);
  }
  return true;
}

void factor_ldlt(int n, double* A, int* order) {
  const auto a = [&](int i, int j) -> double& {
    return A[i >= j ? i + j * n : j + i * n];
  };  // lower triangle
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i)
      if (std::abs(a(i, i)) > std::abs(a(pivot, pivot))) pivot = i;
    order[k] = pivot;
    if (pivot != k) {
      for (int j = 0; j < n; ++j)
        if (j != k && j != pivot) std::swap(a(k, j), a(pivot, j));
      std::swap(a(k, k), a(pivot, pivot));
    }
    const double d = a(k, k);
    if (d == 0) continue;  // then all that is left is zero, or the matrix indefinite
    for (int j = k + 1; j < n; ++j) {
      const double factor = a(j, k) / d;
      for (int i = j; i < n; ++i) a(i, j) -= factor * a(i, k);
    }
    for (int i = k + 1; i < n; ++i) a(i, k) /= d;
  }
}

void solve_ldlt(int n, const double* factors, const int* order, int columns, double* B) {
  for (int c = 0; c < columns; ++c) {
    double* b = B + c * n;
    for (int k = 0; k < n; ++k) std::swap(b[k], b[order[k]]);
    for (int k = 0; k < n; ++k)
      for (int i = k + 1; i < n; ++i) b[i] -= factors[i + k * n] * b[k];
    for (int k = 0; k < n; ++k) b[k] /= factors[k + k * n];
    for (int k = n - 1; k >= 0; --k)
      for (int i = k + 1; i < n; ++i) b[k] -= factors[i + k * n] * b[i];
    for (int k = n - 1; k >= 0; --k) std::swap(b[k], b[order[k]]);
  }
}

}  // namespace taut::detail
