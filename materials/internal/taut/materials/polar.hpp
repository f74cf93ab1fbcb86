#pragma once
/// \file
/// The rotation of the polar decomposition F = R U, eight particles at once.

#include <taut/materials/tensor_pack.hpp>

namespace taut {

/// R of F = R U; NaN where det F <= 0. In 3D Newton's iteration with the scaling of Higham, "Computing the
/// polar decomposition — with applications", SIAM J. Sci. Stat. Comput. 7 (1986): R <- (g R + R^-T / g) / 2,
/// g² = |R^-1| / |R|. Any g near that will do, so the fourth root is taken by dividing exponents. Four scaled
/// and two plain steps reach round-off for stretches between 0.01 and 100.
template <int D>
TAUT_INLINE TensorPack<D> polar_rotation(const TensorPack<D>& F) {
  if constexpr (D == 1) {
    return {{select(F.c[0] > 0.0, pack(1), pack_nan())}};
  } else if constexpr (D == 2) {
    const Pack c = F(0, 0) + F(1, 1), s = F(1, 0) - F(0, 1);
    const Pack J = F(0, 0) * F(1, 1) - F(0, 1) * F(1, 0);
    const Pack norm = pack_sqrt(c * c + s * s);
    const Pack scale = select(J > 0.0, 1.0 / norm, pack_nan());
    return {{c * scale, -s * scale, s * scale, c * scale}};
  } else {
    constexpr int scaled_steps = 4, plain_steps = 2;
    const Pack J = determinant(F, cofactor(F));
    TensorPack<3> R = F;
    for (int step = 0; step < scaled_steps + plain_steps; ++step) {
      const TensorPack<3> cof = cofactor(R);
      const Pack det = determinant(R, cof);
      Pack g = pack(1);
      if (step < scaled_steps) {
        // g^4 = |cof R|² / (|R|² det²)
        const PackMask quarter = (std::bit_cast<PackMask>(norm_squared(cof)) -
                                  std::bit_cast<PackMask>(norm_squared(R) * det * det)) >>
                                 2;
        g = std::bit_cast<Pack>(quarter + std::bit_cast<PackMask>(pack(1)));
      }
      const Pack half = 0.5 * g, half_inverse = 0.5 / (det * g);
      for (int i = 0; i < 9; ++i) R.c[i] = half * R.c[i] + half_inverse * cof.c[i];
    }
    for (int i = 0; i < 9; ++i) R.c[i] = select(J > 0.0, R.c[i], pack_nan());
    return R;
  }
}

}  // namespace taut
