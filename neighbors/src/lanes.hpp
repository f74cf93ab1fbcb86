#pragma once
// Eight doubles, one a lane of a slice, in registers of the width that the processor has, and the bit masks
// of their comparisons. Comparing packs into an eight-bit mask is the one thing that the compilers' vector
// extensions cannot say, hence the few intrinsics.

#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>
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

// Part by part: g++ copies a whole struct through the stack in pieces that stall the loads after them.
template <class Register>
inline Register load_part(const void* p) {
  Register v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline Double8 load8(const double* p) { TAUT_LANES(load_part<Part>(p + i * width)); }
inline Double8 splat8(double v) {
#if defined(__AVX512F__)
  return {{Part{v, v, v, v, v, v, v, v}}};
#elif defined(__AVX__)
  return {{Part{v, v, v, v}, Part{v, v, v, v}}};
#else
  return {{Part{v, v}, Part{v, v}, Part{v, v}, Part{v, v}}};
#endif
}
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

// Thirty-two bytes.
#if defined(__AVX2__)
typedef std::uint8_t BytePart __attribute__((vector_size(32)));
#else
typedef std::uint8_t BytePart __attribute__((vector_size(16)));
#endif
struct Bytes32 {
  BytePart part[32 / sizeof(BytePart)];
};
#define TAUT_BYTES(expression)                                               \
  Bytes32 r;                                                                 \
  for (unsigned i = 0; i < std::size(r.part); ++i) r.part[i] = (expression); \
  return r

inline Bytes32 load_bytes(const std::uint8_t* p) {
  TAUT_BYTES(load_part<BytePart>(p + i * sizeof(BytePart)));
}
inline Bytes32 splat_bytes(int v) {
  BytePart all;
  std::memset(&all, v, sizeof all);
  TAUT_BYTES(all);
}
inline Bytes32 operator|(const Bytes32& a, const Bytes32& b) { TAUT_BYTES(a.part[i] | b.part[i]); }
inline Bytes32 operator&(const Bytes32& a, const Bytes32& b) { TAUT_BYTES(a.part[i] & b.part[i]); }
inline Bytes32 operator+(const Bytes32& a, const Bytes32& b) { TAUT_BYTES(a.part[i] + b.part[i]); }
inline Bytes32 operator-(const Bytes32& a, const Bytes32& b) { TAUT_BYTES(a.part[i] - b.part[i]); }
// Bytes shifted by `by` bits; the bits in `keep` only.
template <int by>
inline Bytes32 shift_right(const Bytes32& a, int keep) {
  typedef std::uint16_t Shorts __attribute__((vector_size(sizeof(BytePart))));
  Bytes32 r;
  for (unsigned i = 0; i < std::size(r.part); ++i)
    r.part[i] = reinterpret_cast<BytePart>(reinterpret_cast<Shorts>(a.part[i]) >> by);
  return r & splat_bytes(keep);
}
#undef TAUT_BYTES

// Bit i is the highest bit of byte i.
inline std::uint32_t highest_bits(const Bytes32& a) {
#if defined(__AVX2__)
  return static_cast<std::uint32_t>(_mm256_movemask_epi8(reinterpret_cast<__m256i>(a.part[0])));
#elif defined(__SSE2__)
  return static_cast<std::uint32_t>(_mm_movemask_epi8(reinterpret_cast<__m128i>(a.part[0]))) |
         static_cast<std::uint32_t>(_mm_movemask_epi8(reinterpret_cast<__m128i>(a.part[1]))) << 16;
#else
  std::uint32_t m = 0;
  for (unsigned i = 0; i < 32; ++i)
    m |= static_cast<std::uint32_t>(a.part[i / sizeof(BytePart)][i % sizeof(BytePart)] >> 7) << i;
  return m;
#endif
}
// Bit i is set where byte i is not zero.
inline std::uint32_t nonzero(const Bytes32& a) {
  Bytes32 r;
  for (unsigned i = 0; i < std::size(r.part); ++i) r.part[i] = reinterpret_cast<BytePart>(a.part[i] != 0);
  return highest_bits(r);
}
// Bit i is set where byte i has at least `count` bits set.
template <int count>
inline std::uint32_t at_least(const Bytes32& a) {
  const Bytes32 pairs = a - shift_right<1>(a, 0x55);
  const Bytes32 fours = (pairs & splat_bytes(0x33)) + shift_right<2>(pairs, 0x33);
  const Bytes32 sum = (fours + shift_right<4>(fours, 0x0f)) & splat_bytes(0x0f);
  return highest_bits(sum + splat_bytes(0x80 - count));
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

// Stores those of the eight numbers at `from` that the mask picks; what follows them, up to eight numbers, is
// overwritten too. Returns the end of those picked.
inline Index* store_picked(const Index* from, unsigned mask, Index* to) {
#if defined(__AVX512F__) && defined(__AVX512VL__)
  const __m256i all = load_part<__m256i>(from);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                      _mm256_maskz_compress_epi32(static_cast<__mmask8>(mask), all));
#else
  const std::uint32_t* const places = mask_tables.places[mask].data();
  for (int i = 0; i < lanes; ++i) to[i] = from[places[i]];
#endif
  return to + mask_tables.count[mask];
}

}  // namespace taut::detail
