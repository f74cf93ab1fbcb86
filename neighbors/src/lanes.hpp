#pragma once
// Eight doubles, one a lane of a slice, in registers of the width that the processor has, and the bit masks
// of their comparisons. Comparing packs into an eight-bit mask is the one thing that the compilers' vector
// extensions cannot say, hence the few intrinsics.

#include <array>
#include <cstdint>
#include <cstring>
#include <taut/core/types.hpp>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace taut::detail {

#if defined(__AVX512F__)
inline constexpr int width = 8;
#elif defined(__AVX__)
inline constexpr int width = 4;
#else
inline constexpr int width = 2;
#endif

typedef double Part __attribute__((vector_size(width * sizeof(double))));

struct Double8 {
  Part part[lanes / width];
};

#define TAUT_LANES(expression)                                      \
  Double8 r;                                                        \
  for (int i = 0; i < lanes / width; ++i) r.part[i] = (expression); \
  return r

inline Double8 load8(const double* p) {
  Double8 r;
  std::memcpy(&r, p, sizeof r);
  return r;
}
inline Double8 splat8(double v) { TAUT_LANES(Part{} + v); }
inline Double8 operator+(const Double8& a, const Double8& b) { TAUT_LANES(a.part[i] + b.part[i]); }
inline Double8 operator-(const Double8& a, const Double8& b) { TAUT_LANES(a.part[i] - b.part[i]); }
inline Double8 operator*(const Double8& a, const Double8& b) { TAUT_LANES(a.part[i] * b.part[i]); }
inline Double8 max(const Double8& a, const Double8& b) {
  TAUT_LANES(a.part[i] > b.part[i] ? a.part[i] : b.part[i]);
}
inline Double8 min(const Double8& a, const Double8& b) {
  TAUT_LANES(a.part[i] < b.part[i] ? a.part[i] : b.part[i]);
}
#undef TAUT_LANES

// Bit l is set where a < b in lane l; false where either is NaN.
inline unsigned less(const Double8& a, const Double8& b) {
#if defined(__AVX512F__)
  return _mm512_cmp_pd_mask(a.part[0], b.part[0], _CMP_LT_OQ);
#else
  unsigned m = 0;
  for (int i = 0; i < lanes / width; ++i) {
#if defined(__AVX__)
    const int bits = _mm256_movemask_pd(_mm256_cmp_pd(a.part[i], b.part[i], _CMP_LT_OQ));
#elif defined(__SSE2__)
    const int bits = _mm_movemask_pd(_mm_cmplt_pd(a.part[i], b.part[i]));
#else
    const int bits = (a.part[i][0] < b.part[i][0]) | (a.part[i][1] < b.part[i][1]) << 1;
#endif
    m |= static_cast<unsigned>(bits) << (i * width);
  }
  return m;
#endif
}

// For each eight-bit mask: how many bits are set, the places of the set bits in ascending order, and the bits
// spread over the bytes of a word (byte l is 1 where bit l is set).
struct MaskTables {
  std::array<std::uint8_t, 256> count{};
  std::array<std::array<std::uint32_t, 8>, 256> places{};
  std::array<std::uint64_t, 256> spread{};
};
inline constexpr MaskTables mask_tables = [] {
  MaskTables t;
  for (unsigned m = 0; m < 256; ++m)
    for (unsigned l = 0; l < 8; ++l)
      if (m >> l & 1) {
        t.places[m][t.count[m]++] = l;
        t.spread[m] |= std::uint64_t{1} << (8 * l);
      }
  return t;
}();

}  // namespace taut::detail
