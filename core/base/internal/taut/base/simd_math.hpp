#pragma once
/// \file
/// Elementary functions of packs: no branches, no tables, the same bits on every lane.

#include <bit>
#include <cmath>
#include <limits>
#include <taut/base/simd.hpp>

namespace taut {

typedef std::uint64_t PackBits __attribute__((vector_size(lanes * sizeof(std::uint64_t))));

TAUT_INLINE Pack select(PackMask mask, Pack yes, Pack no) { return mask ? yes : no; }
TAUT_INLINE Pack pack_nan() { return pack(std::numeric_limits<double>::quiet_NaN()); }

/// One vector instruction under -fno-math-errno; NaN for x < 0.
TAUT_INLINE Pack pack_sqrt(Pack x) {
  Pack r;
  for (int i = 0; i < lanes; ++i) r[i] = std::sqrt(x[i]);
  return r;
}

/// 1.5 * 2^52: a double near it counts units in the low bits of its mantissa, so that adding it rounds to an
/// integer and shows that integer in the bits. (Not every target converts packs of 64-bit integers.)
inline constexpr double pack_shift = 6755399441055744.0;

/// Two's-complement integers of magnitude below 2^51, as doubles.
TAUT_INLINE Pack pack_to_double(PackBits n) {
  return std::bit_cast<Pack>(n + std::bit_cast<PackBits>(pack(pack_shift))) - pack_shift;
}

/// Natural logarithm to 1 ulp; NaN for x <= 0 (also for x = 0, unlike std::log: a volume that vanished is an
/// error). The reduction and the coefficients are those of fdlibm's e_log.c (Sun Microsystems 1993): x = 2^k
/// (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)), ln(1 + f) = f - f²/2 + s (f²/2 + R(s²)), s = f / (2 + f).
TAUT_INLINE Pack pack_log(Pack x) {
  constexpr double least_normal = std::numeric_limits<double>::min();
  const PackMask subnormal = x < least_normal;
  const Pack scaled = select(subnormal, x * 0x1p54, x);

  constexpr std::uint64_t one = 0x3ff0000000000000, sqrt_half = 0x3fe6a09e00000000,
                          mantissa = 0x000fffffffffffff;
  const PackBits bits = std::bit_cast<PackBits>(scaled) + (one - sqrt_half);
  const Pack k = pack_to_double((bits >> 52) - 0x3ff) - select(subnormal, pack(54), pack(0));
  const Pack f = std::bit_cast<Pack>((bits & mantissa) + sqrt_half) - 1.0;

  const Pack s = f / (2.0 + f), z = s * s, w = z * z;
  const Pack even =
      w * (3.999999999940941908e-01 + w * (2.222219843214978396e-01 + w * 1.531383769920937332e-01));
  const Pack odd =
      z * (6.666666666666735130e-01 +
           w * (2.857142874366239149e-01 + w * (1.818357216161805012e-01 + w * 1.479819860511658591e-01)));
  const Pack half_square = 0.5 * f * f;
  const Pack value =
      k * 6.93147180369123816490e-01 -
      ((half_square - (s * (half_square + (even + odd)) + k * 1.90821492927058770002e-10)) - f);

  constexpr double inf = std::numeric_limits<double>::infinity();
  const Pack finite = select(x > 0.0, value, pack_nan());
  return select(x == inf, x, finite);
}

/// ln(1 + x), accurate also for small x; NaN for x <= -1. The rounding error of 1 + x is put back to first
/// order.
TAUT_INLINE Pack pack_log1p(Pack x) {
  const Pack u = 1.0 + x;
  return pack_log(u) + (x - (u - 1.0)) / u;
}

/// exp(x) to a relative error of 1e-4 for |x| < 700: a start for iterations.
TAUT_INLINE Pack pack_exp_rough(Pack x) {
  const Pack shifted = x * 1.4426950408889634 + pack_shift;
  const Pack r = x - (shifted - pack_shift) * 0.6931471805599453;
  const Pack p = 1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6 + r * (1.0 / 24))));
  const PackBits exponent = std::bit_cast<PackBits>(shifted) << 52;
  return std::bit_cast<Pack>(std::bit_cast<PackBits>(p) + exponent);
}

}  // namespace taut
