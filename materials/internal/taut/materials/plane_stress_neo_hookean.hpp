#pragma once
/// \file
/// The thickness of a neo-Hookean sheet in plane stress.

#include <taut/base/simd_math.hpp>

namespace taut {

/// Square of the stretch through the thickness, and by how much it exceeds 1 (accurate where that is small).
struct SquaredThickness {
  Pack w, excess;
};

/// ln w, accurate near w = 1.
TAUT_INLINE Pack log_of(const SquaredThickness& t) {
  const Pack rounding = select(t.w > 0.5, (t.excess - (t.w - 1.0)) / t.w, pack(0));
  return pack_log(t.w) + rounding;
}

/// Solves P_33 = 0, mu (w - 1) + lambda (ln J2 + ln(w) / 2) = 0 or w + a ln w = 1 - 2 a ln J2, a = lambda /
/// (2 mu), for w = F_33², given ln J2 of the in-plane J2. This is Lambert's W function, and the iteration the
/// fourth-order one of Fritsch, Shafer and Crowley, "Solution of the transcendental equation w e^w = x", CACM
/// 16 (1973), written so that a may be 0. From the start below, right to 2 for J2 between 0.01 and 100, three
/// steps reach round-off for every a >= 0. For a < 0 the root is that which grows out of w = 1; where J2 is
/// so small that it does not exist, NaN.
TAUT_INLINE SquaredThickness squared_thickness(Pack log_J2, double a) {
  const Pack tangent = (-2 * a / (1 + a)) * log_J2;
  Pack y = tangent;
  if (a >= 0) {
    const double bend = a / ((1 + a) * (1 + a));
    const Pack compressed = tangent / (1.0 - bend * log_J2);
    const Pack asymptote = 1 / a - 2.0 * log_J2;
    y = select(log_J2 < 0.0, compressed, select(asymptote < tangent, asymptote, tangent));
  }
  SquaredThickness t;
  t.w = pack_exp_rough(y);
  t.excess = t.w - 1.0;
  Pack step;
  const int steps = a >= 0 ? 3 : 8;
  for (int i = 0; i < steps; ++i) {
    const Pack sum = a + t.w;
    const Pack r = (-2 * a * log_J2 - t.excess - a * log_of(t)) / sum;
    const Pack q = 2.0 * sum * (1.0 + (2.0 / 3) * r);
    step = r * (q - a * r) / (q - 2 * a * r);
    t.excess += t.w * step;
    t.w += t.w * step;
  }
  if (a < 0) {
    const PackMask found = (step < 1e-6) & (step > -1e-6) & (t.w > -a);
    t.w = select(found, t.w, pack_nan());
    t.excess = select(found, t.excess, pack_nan());
  }
  return t;
}

}  // namespace taut
