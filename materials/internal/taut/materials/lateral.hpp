#pragma once
/// \file
/// What laws say of the axes that a body does not have.

#include <taut/materials/models.hpp>
#include <taut/materials/tensor_pack.hpp>

namespace taut {

/// One value for all axes that are missing: laws are isotropic, and in 1D both are held alike.
template <int D>
TAUT_INLINE void store_lateral(const StressBlock<D>& block, int p, Pack P, Pack F) {
  for (int k = 0; k < 3 - D; ++k) {
    store(block.P_lateral + k * block.stride + p, P);
    store(block.F_lateral + k * block.stride + p, F);
  }
}

/// Hooke's law for a strain of which the in-plane trace is known: stress lambda tr and no strain along the
/// axes that are held, strain -nu / (1 - nu) tr and no stress across a plane in plane stress.
struct LateralHooke {
  double stress, strain;
};
template <int D>
LateralHooke lateral_hooke(const MaterialParameters& parameters) {
  if (is_plane_stress<D>(parameters)) return {0, -parameters.nu / (1 - parameters.nu)};
  return {parameters.lambda(), 0};
}

/// The same for laws S(E) in the Green strain E: F_kk = sqrt(1 + 2 E_kk), P_kk = F_kk S_kk.
template <int D>
TAUT_INLINE void store_lateral(const StressBlock<D>& block, int p, const TensorPack<D>& E,
                               const LateralHooke& hooke) {
  const Pack tr = trace(E), stretch = pack_sqrt(1.0 + (2 * hooke.strain) * tr);
  store_lateral(block, p, stretch * (hooke.stress * tr), stretch);
}

}  // namespace taut
