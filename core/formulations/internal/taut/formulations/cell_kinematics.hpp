#pragma once
/// \file
/// Deformation of eight cells, and the forces of their stresses on the corners.

#include <taut/base/simd.hpp>
#include <taut/formulations/cell_modes.hpp>
#include <taut/formulations/cell_strips.hpp>
#include <taut/operators/pair_payload.hpp>

namespace taut {

/// Modes of the corners of cells j to j + 7 of a strip; behind its end the last cell is repeated.
template <int D>
TAUT_INLINE void load_modes(const typename CellStrips<D>::Strip& s, Index j, const Columns<D>& x,
                            Pack (&modes)[D][cell_corners<D>]) {
  constexpr int rows = CellStrips<D>::rows;
  if (j + lanes <= s.count) {
    for (int r = 0; r < rows; ++r)
      for (int d = 0; d < D; ++d) {
        const double* from = x.c[d] + s.row[static_cast<std::size_t>(r)] + j;
        modes[d][2 * r] = load(from);
        modes[d][2 * r + 1] = load(from + 1);
      }
  } else {
    for (int r = 0; r < rows; ++r) {
      Index at[lanes];
      for (int l = 0; l < lanes; ++l)
        at[l] = s.row[static_cast<std::size_t>(r)] + std::min(j + l, s.count - 1);
      for (int d = 0; d < D; ++d) {
        modes[d][2 * r] = gather(x.c[d], at);
        modes[d][2 * r + 1] = gather(x.c[d] + 1, at);
      }
    }
  }
  for (int d = 0; d < D; ++d) corners_to_modes<D>(modes[d]);
}

/// Hourglass amplitudes, q_m = u_m - H X_m (= x_m - F X_m).
template <int D>
struct Bends {
  static constexpr int count = hourglass_modes<D>.size();
  Pack q[count > 0 ? count : 1][D];
};

/// Hourglass stiffness of mode m over that of the first one: the strains of the mode that changes sign along
/// all three axes are as large, on a third of the volume.
constexpr double relative_stiffness(int mode) { return mode == 7 ? 1.0 / 3 : 1.0; }

/// Equal boxes along the axes: their volume and D numbers, and no hourglass modes at rest.
template <int D>
class BoxCells {
 public:
  BoxCells() = default;
  BoxCells(const typename CellStrips<D>::Strip& s, Index, const Columns<D>&) : volume_(s.spacing.prod()) {
    for (int d = 0; d < D; ++d) {
      g_[d] = 2.0 / (cell_corners<D> * s.spacing[d]);
      stiffness_ += volume_ * g_[d] * g_[d];
    }
  }
  TAUT_INLINE Pack volume() const { return pack(volume_); }
  /// sum over `volume_modes` of |b_m|^2 / V, to which hourglass stiffness is proportional.
  TAUT_INLINE Pack stiffness() const { return pack(stiffness_); }
  /// H = F - I and the hourglass amplitudes from the modes of the corners' displacements.
  TAUT_INLINE void deform(const Pack (&u)[D][cell_corners<D>], Pack (&H)[D * D], Bends<D>& bends) const {
    for (int d = 0; d < D; ++d)
      for (int e = 0; e < D; ++e) H[d * D + e] = u[d][1 << e] * g_[e];
    for (int m = 0; m < bends.count; ++m)
      for (int d = 0; d < D; ++d) bends.q[m][d] = u[d][hourglass_modes<D>[static_cast<std::size_t>(m)]];
  }
  /// Modes of the corners' forces from P (component c at P[c * stride]) and the stiffness of the first bend.
  TAUT_INLINE void forces(const double* P, std::size_t stride, const Bends<D>& bends, Pack k, Pack share,
                          Pack (&f)[D][cell_corners<D>]) const {
    for (int d = 0; d < D; ++d) {
      f[d][0] = pack(0);
      for (int e = 0; e < D; ++e)
        f[d][1 << e] = load(P + static_cast<std::size_t>(d * D + e) * stride) * (share * (-volume_ * g_[e]));
      for (int m = 0; m < bends.count; ++m) {
        const int mode = hourglass_modes<D>[static_cast<std::size_t>(m)];
        f[d][mode] = bends.q[m][d] * (share * k * -relative_stiffness(mode));
      }
    }
  }

 private:
  double g_[D], volume_, stiffness_ = 0;
};

/// Any cells, from the modes of their corners at rest.
template <int D>
class SkewCells {
 public:
  SkewCells() = default;
  TAUT_INLINE SkewCells(const typename CellStrips<D>::Strip& s, Index j, const Columns<D>& X) {
    Pack modes[D][cell_corners<D>];
    load_modes<D>(s, j, X, modes);
    of_.set(modes);
    per_volume_ = 1 / of_.V;
    stiffness_ = pack(0);
    for (std::size_t m = 0; m < volume_modes<D>.size(); ++m)
      for (int d = 0; d < D; ++d) stiffness_ += of_.b[m][d] * of_.b[m][d];
    stiffness_ *= per_volume_;
    for (int m = 0; m < rest_.count; ++m)
      for (int d = 0; d < D; ++d) rest_.q[m][d] = modes[d][hourglass_modes<D>[static_cast<std::size_t>(m)]];
  }
  TAUT_INLINE Pack volume() const { return of_.V; }
  TAUT_INLINE Pack stiffness() const { return stiffness_; }
  TAUT_INLINE void deform(const Pack (&u)[D][cell_corners<D>], Pack (&H)[D * D], Bends<D>& bends) const {
    for (int d = 0; d < D; ++d)
      for (int e = 0; e < D; ++e) {
        H[d * D + e] = u[d][volume_modes<D>[0]] * of_.b[0][e];
        for (std::size_t m = 1; m < volume_modes<D>.size(); ++m)
          H[d * D + e] += u[d][volume_modes<D>[m]] * of_.b[m][e];
        H[d * D + e] *= per_volume_;
      }
    for (int m = 0; m < bends.count; ++m)
      for (int d = 0; d < D; ++d) {
        bends.q[m][d] = u[d][hourglass_modes<D>[static_cast<std::size_t>(m)]];
        for (int e = 0; e < D; ++e) bends.q[m][d] -= H[d * D + e] * rest_.q[m][e];
      }
  }
  TAUT_INLINE void forces(const double* P, std::size_t stride, const Bends<D>& bends, Pack k, Pack share,
                          Pack (&f)[D][cell_corners<D>]) const {
    const Pack minus = -share;
    for (int d = 0; d < D; ++d) {
      // Bends depend on F as well, which adds to its conjugate.
      Pack Q[D], bend[Bends<D>::count > 0 ? Bends<D>::count : 1];
      for (int e = 0; e < D; ++e) Q[e] = minus * load(P + static_cast<std::size_t>(d * D + e) * stride);
      for (int m = 0; m < bends.count; ++m) {
        bend[m] =
            bends.q[m][d] * (minus * k * relative_stiffness(hourglass_modes<D>[static_cast<std::size_t>(m)]));
        for (int e = 0; e < D; ++e) Q[e] -= bend[m] * rest_.q[m][e] * per_volume_;
      }
      for (int mode = 0; mode < cell_corners<D>; ++mode) f[d][mode] = pack(0);
      for (int m = 0; m < bends.count; ++m) f[d][hourglass_modes<D>[static_cast<std::size_t>(m)]] = bend[m];
      for (std::size_t m = 0; m < volume_modes<D>.size(); ++m)
        for (int e = 0; e < D; ++e) f[d][volume_modes<D>[m]] += Q[e] * of_.b[m][e];
    }
  }

 private:
  CellVectors<D> of_;
  Pack per_volume_, stiffness_;
  Bends<D> rest_;
};

}  // namespace taut
