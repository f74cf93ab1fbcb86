#pragma once
/// \file
/// Cells of 2^D corners in terms of their modes, eight cells at a time.
///
/// Mode m of values v_I at the corners is the sum over the corners of h_mI v_I, h_mI the product over the
/// bits d of m of the sign (-1 or 1) of corner I along axis d: the mean for m = 0, slopes for single bits,
/// twists and bends for more (the hourglass modes of Flanagan & Belytschko 1981). The volume of a cell is a
/// polynomial of the modes of its corners, and its derivatives are few.

#include <array>
#include <taut/base/simd.hpp>
#include <taut/base/types.hpp>

namespace taut {

template <int D>
inline constexpr int cell_corners = 1 << D;

/// Modes that the volume depends on. In 3D the last one, all bits set, does not count.
template <int D>
inline constexpr auto volume_modes = [] {
  if constexpr (D == 1) return std::array{1};
  if constexpr (D == 2) return std::array{1, 2};
  if constexpr (D == 3) return std::array{1, 2, 4, 3, 5, 6};
}();
/// Modes that are neither mean nor slope.
template <int D>
inline constexpr auto hourglass_modes = [] {
  if constexpr (D == 1) return std::array<int, 0>{};
  if constexpr (D == 2) return std::array{3};
  if constexpr (D == 3) return std::array{3, 5, 6, 7};
}();

/// Values at the corners become modes.
template <int D>
TAUT_INLINE void corners_to_modes(Pack (&v)[cell_corners<D>]) {
  for (int bit = 1; bit < cell_corners<D>; bit *= 2)
    for (int c = 0; c < cell_corners<D>; ++c) {
      if (c & bit) continue;
      const Pack low = v[c], high = v[c | bit];
      v[c] = low + high;
      v[c | bit] = high - low;
    }
}

/// The adjoint: value at corner I is the sum over the modes of h_mI v_m.
template <int D>
TAUT_INLINE void modes_to_corners(Pack (&v)[cell_corners<D>]) {
  for (int bit = 1; bit < cell_corners<D>; bit *= 2)
    for (int c = 0; c < cell_corners<D>; ++c) {
      if (c & bit) continue;
      const Pack even = v[c], odd = v[c | bit];
      v[c] = even - odd;
      v[c | bit] = even + odd;
    }
}

/// Derivatives of the volume with respect to the corners: B_I = sum over `volume_modes` of h_mI b_m. The
/// volume is that of the region between straight edges (2D) or bilinear faces (3D), the integral of det
/// dX/dxi, so that cells fill space without gaps: `X[d][m]` are the modes of coordinate d, and
///   sum_m X_m (x) b_m = sum_I X_I (x) B_I = V I
/// holds identically, for V is the Jacobian determinant's mean and scales with it under linear maps.
template <int D>
struct CellVectors {
  Pack b[volume_modes<D>.size()][D];
  Pack V;

  TAUT_INLINE void set(const Pack (&X)[D][cell_corners<D>]) {
    if constexpr (D == 1) {
      b[0][0] = pack(1);
    } else if constexpr (D == 2) {
      b[0][0] = 0.25 * X[1][2], b[0][1] = -0.25 * X[0][2];
      b[1][0] = -0.25 * X[1][1], b[1][1] = 0.25 * X[0][1];
    } else {
      constexpr double slope = 1.0 / 64, bend = 1.0 / 192;
      cross(b[0], slope, X, 2, 4, bend, 3, 5);
      cross(b[1], slope, X, 4, 1, bend, 6, 3);
      cross(b[2], slope, X, 1, 2, bend, 5, 6);
      cross(b[3], bend, X, 2, 6, bend, 5, 1);
      cross(b[4], bend, X, 1, 3, bend, 6, 4);
      cross(b[5], bend, X, 4, 5, bend, 3, 2);
    }
    V = X[0][1] * b[0][0];
    for (std::size_t m = 1; m < volume_modes<D>.size(); ++m) V += X[0][volume_modes<D>[m]] * b[m][0];
  }

 private:
  // f X_i x X_j + g X_k x X_l
  TAUT_INLINE static void cross(Pack (&to)[D], double f, const Pack (&X)[D][cell_corners<D>], int i, int j,
                                double g, int k, int l) {
    for (int d = 0; d < D; ++d) {
      const int e = (d + 1) % D, o = (d + 2) % D;
      to[d] = f * (X[e][i] * X[o][j] - X[o][i] * X[e][j]) + g * (X[e][k] * X[o][l] - X[o][k] * X[e][l]);
    }
  }
};

}  // namespace taut
