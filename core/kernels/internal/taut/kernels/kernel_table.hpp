#pragma once
/// \file
/// A kernel as piecewise cubics of the squared distance, eight pairs at a time, for pair loops whose
/// distances change.

#include <taut/base/fields.hpp>
#include <taut/base/simd.hpp>
#include <taut/kernels/kernel.hpp>

namespace taut {

/// W(r) and W'(r)/r of one kernel for one smoothing length. For r > 0.2 h the error is below 1e-9 of the
/// function's maximum there; nearer to zero both stay finite. Exactly zero from the support radius on, and
/// for NaN.
///
/// The intervals are uniform within each octave of t = (r / support)^2 + 1/32: the exponent and the leading
/// bits of t number the interval and the other bits are the place within it, so that no square root is taken;
/// and they shrink towards r = 0, where a function that is smooth in r is not smooth in r^2.
class KernelTable {
 public:
  /// For smoothing length `h` [m]. \throws InputError when h is not positive and finite.
  KernelTable(const Kernel& kernel, double h);

  /// W [1/m^D] at squared distances [m^2].
  TAUT_INLINE Pack value(Pack r2) const { return evaluate(value_.data(), r2); }
  /// W'(r)/r [1/m^(D+2)] at squared distances [m^2]: times x_a - x_b it is the gradient of W_ab at a.
  TAUT_INLINE Pack slope_over_r(Pack r2) const { return evaluate(slope_over_r_.data(), r2); }

  double support() const { return support_; }  ///< support radius [m]

 private:
  static constexpr int octaves = 5;
  static constexpr int bits = 8;  // 2^bits intervals an octave
  static constexpr double offset = 1.0 / (1 << octaves);
  static constexpr int shift = 52 - bits;                  // 52 bits follow the exponent of a double
  static constexpr std::int64_t one = 0x3ff0000000000000;  // 1.0
  static constexpr std::int64_t mantissa = (std::int64_t{1} << 52) - 1;
  static constexpr std::int64_t first_interval = (one >> shift) - (octaves << bits);
  static constexpr int intervals = (octaves << bits) + (1 << (bits - octaves));  // up to t = 1 + offset

  typedef double Cubic __attribute__((vector_size(4 * sizeof(double))));

  TAUT_INLINE Pack evaluate(const double* cubics, Pack r2) const {
    const PackMask inside = r2 < pack(support_ * support_);
    const Pack t = pack(offset) + (inside ? r2 * pack(scale_) : pack(0));
    PackMask t_bits;
    std::memcpy(&t_bits, &t, sizeof t);
    const PackMask interval = (t_bits >> shift) - first_interval;
    const PackMask u_bits = (t_bits << bits & mantissa) | one;
    Pack u;
    std::memcpy(&u, &u_bits, sizeof u);
    u -= pack(1);
    // One load an interval, then a transposition: half the time of four gathers.
    const Pack q01 = load_two(cubics, interval[0], interval[1]),
               q23 = load_two(cubics, interval[2], interval[3]);
    const Pack q45 = load_two(cubics, interval[4], interval[5]),
               q67 = load_two(cubics, interval[6], interval[7]);
    const Pack low03 = __builtin_shufflevector(q01, q23, 0, 4, 8, 12, 1, 5, 9, 13);
    const Pack low47 = __builtin_shufflevector(q45, q67, 0, 4, 8, 12, 1, 5, 9, 13);
    const Pack high03 = __builtin_shufflevector(q01, q23, 2, 6, 10, 14, 3, 7, 11, 15);
    const Pack high47 = __builtin_shufflevector(q45, q67, 2, 6, 10, 14, 3, 7, 11, 15);
    const Pack c0 = __builtin_shufflevector(low03, low47, 0, 1, 2, 3, 8, 9, 10, 11);
    const Pack c1 = __builtin_shufflevector(low03, low47, 4, 5, 6, 7, 12, 13, 14, 15);
    const Pack c2 = __builtin_shufflevector(high03, high47, 0, 1, 2, 3, 8, 9, 10, 11);
    const Pack c3 = __builtin_shufflevector(high03, high47, 4, 5, 6, 7, 12, 13, 14, 15);
    return inside ? c0 + u * (c1 + u * (c2 + u * c3)) : pack(0);
  }

  TAUT_INLINE static Pack load_two(const double* cubics, std::int64_t i, std::int64_t j) {
    Cubic a, b;
    std::memcpy(&a, cubics + 4 * i, sizeof a);
    std::memcpy(&b, cubics + 4 * j, sizeof b);
    return __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
  }

  double support_ = 0, scale_ = 0;
  AlignedArray<double> value_, slope_over_r_;  // four coefficients an interval
};

}  // namespace taut
