#pragma once
// Packs in registers of the width that the processor has: eight doubles, sixteen floats, a string of bytes;
// and the bit masks of their comparisons, which the compilers' vector extensions cannot say, hence the few
// intrinsics. Each has a portable twin.

#include <array>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <taut/base/types.hpp>
#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include <taut/neighbors/simd.hpp>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

#if TAUT_SIMD >= 2
inline constexpr int width = 8;
#elif TAUT_SIMD >= 1
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
#if TAUT_SIMD >= 2
  return {{Part{v, v, v, v, v, v, v, v}}};
#elif TAUT_SIMD >= 1
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
#if TAUT_SIMD >= 2
  return _mm512_cmp_pd_mask(a.part[0], b.part[0], _CMP_LT_OQ);
#else
  unsigned m = 0;
  for (int i = 0; i < lanes / width; ++i) {
#if TAUT_SIMD >= 1
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

// Floats: a register of them, or sixteen, those of two slices.
inline constexpr int floats = 16;
typedef float FloatPart __attribute__((vector_size(2 * width * sizeof(float))));
typedef float HalfPart __attribute__((vector_size(width * sizeof(float))));

template <int parts>
struct Floats {
  static constexpr int part_size = 2 * width, size = parts * part_size;
  FloatPart part[parts];
};
using FloatRegister = Floats<1>;
using Float16 = Floats<floats / FloatRegister::size>;

#define TAUT_FLOATS(expression)                         \
  Floats<n> r;                                          \
  for (int i = 0; i < n; ++i) r.part[i] = (expression); \
  return r

template <int n>
inline Floats<n> splat_floats(float v) {
  TAUT_FLOATS(FloatPart{} + v);
}
inline FloatRegister splat_register(float v) { return splat_floats<1>(v); }
inline Float16 splat16(float v) { return splat_floats<floats / FloatRegister::size>(v); }
inline Float16 load16(const float* p) {
  Float16 r;
  for (int i = 0; i < Float16::size / Float16::part_size; ++i)
    r.part[i] = load_part<FloatPart>(p + i * Float16::part_size);
  return r;
}
// The register that begins with number `first` of sixteen, eight of which are at p and eight at q.
inline FloatRegister load_of_two([[maybe_unused]] int first, const float* p, const float* q) {
#if TAUT_SIMD >= 2
  const __m512d low = _mm512_castpd256_pd512(load_part<__m256d>(p));
  return {{reinterpret_cast<FloatPart>(_mm512_insertf64x4(low, load_part<__m256d>(q), 1))}};
#else
  return {{load_part<FloatPart>(first < lanes ? p + first : q + (first - lanes))}};
#endif
}
template <int n>
inline Floats<n> operator+(const Floats<n>& a, const Floats<n>& b) {
  TAUT_FLOATS(a.part[i] + b.part[i]);
}
template <int n>
inline Floats<n> operator-(const Floats<n>& a, const Floats<n>& b) {
  TAUT_FLOATS(a.part[i] - b.part[i]);
}
template <int n>
inline Floats<n> operator*(const Floats<n>& a, const Floats<n>& b) {
  TAUT_FLOATS(a.part[i] * b.part[i]);
}
template <int n>
inline Floats<n> max(const Floats<n>& a, const Floats<n>& b) {
  TAUT_FLOATS(a.part[i] > b.part[i] ? a.part[i] : b.part[i]);
}
template <int n>
inline Floats<n> min(const Floats<n>& a, const Floats<n>& b) {
  TAUT_FLOATS(a.part[i] < b.part[i] ? a.part[i] : b.part[i]);
}
// a b + c, rounded once or twice.
template <int n>
inline Floats<n> multiply_add(const Floats<n>& a, const Floats<n>& b, const Floats<n>& c) {
#if TAUT_SIMD >= 2
  return {{reinterpret_cast<FloatPart>(_mm512_fmadd_ps(reinterpret_cast<__m512>(a.part[0]),
                                                       reinterpret_cast<__m512>(b.part[0]),
                                                       reinterpret_cast<__m512>(c.part[0])))}};
#else
  return a * b + c;
#endif
}
// The smaller of |a| and |b|, where a is not negative; NaN of b left out.
inline FloatRegister least_magnitude(const FloatRegister& a, const FloatRegister& b) {
#if TAUT_SIMD >= 2
  constexpr int least = 2, sign_cleared = 2 << 2;
  return {{reinterpret_cast<FloatPart>(_mm512_range_ps(
      reinterpret_cast<__m512>(a.part[0]), reinterpret_cast<__m512>(b.part[0]), least | sign_cleared))}};
#else
  typedef std::uint32_t Bits __attribute__((vector_size(sizeof(FloatPart))));
  const FloatRegister magnitude = {
      {reinterpret_cast<FloatPart>(reinterpret_cast<Bits>(b.part[0]) & 0x7fffffffu)}};
  return min(magnitude, a);
#endif
}
#undef TAUT_FLOATS

// Bit i is set where a < b in element i; false where either is NaN.
template <int n>
inline unsigned less(const Floats<n>& a, const Floats<n>& b) {
#if TAUT_SIMD >= 2
  return _mm512_cmp_ps_mask(reinterpret_cast<__m512>(a.part[0]), reinterpret_cast<__m512>(b.part[0]),
                            _CMP_LT_OQ);
#else
  unsigned m = 0;
  for (int i = 0; i < n; ++i) {
#if TAUT_SIMD >= 1
    const int bits = _mm256_movemask_ps(
        _mm256_cmp_ps(reinterpret_cast<__m256>(a.part[i]), reinterpret_cast<__m256>(b.part[i]), _CMP_LT_OQ));
#elif defined(__SSE2__)
    const int bits = _mm_movemask_ps(
        _mm_cmplt_ps(reinterpret_cast<__m128>(a.part[i]), reinterpret_cast<__m128>(b.part[i])));
#else
    int bits = 0;
    for (int j = 0; j < 2 * width; ++j) bits |= (a.part[i][j] < b.part[i][j]) << j;
#endif
    m |= static_cast<unsigned>(bits) << (i * 2 * width);
  }
  return m;
#endif
}

// Rounds eight doubles to floats.
inline void store_floats(const Double8& a, float* to) {
  for (int i = 0; i < lanes / width; ++i) {
    const HalfPart half = __builtin_convertvector(a.part[i], HalfPart);
    std::memcpy(to + i * width, &half, sizeof half);
  }
}

// As many bytes as a cache line or half of one has.
#if TAUT_SIMD >= 2
typedef std::uint8_t BytePart __attribute__((vector_size(64)));
inline constexpr int bytes = 64;
#elif TAUT_SIMD >= 1
typedef std::uint8_t BytePart __attribute__((vector_size(32)));
inline constexpr int bytes = 32;
#else
typedef std::uint8_t BytePart __attribute__((vector_size(16)));
inline constexpr int bytes = 32;
#endif
struct Bytes {
  BytePart part[bytes / sizeof(BytePart)];
};
#define TAUT_BYTES(expression)                                               \
  Bytes r;                                                                   \
  for (unsigned i = 0; i < std::size(r.part); ++i) r.part[i] = (expression); \
  return r

inline Bytes load_bytes(const std::uint8_t* p) { TAUT_BYTES(load_part<BytePart>(p + i * sizeof(BytePart))); }
inline void store_bytes(const Bytes& a, std::uint8_t* to) { std::memcpy(to, &a, sizeof a); }
inline Bytes splat_bytes(int v) { TAUT_BYTES(BytePart{} + static_cast<std::uint8_t>(v)); }
inline Bytes operator|(const Bytes& a, const Bytes& b) { TAUT_BYTES(a.part[i] | b.part[i]); }
inline Bytes operator&(const Bytes& a, const Bytes& b) { TAUT_BYTES(a.part[i] & b.part[i]); }
// Those of a that are not of b.
inline Bytes without(const Bytes& a, const Bytes& b) { TAUT_BYTES(a.part[i] & ~b.part[i]); }
inline Bytes operator+(const Bytes& a, const Bytes& b) { TAUT_BYTES(a.part[i] + b.part[i]); }
inline Bytes operator-(const Bytes& a, const Bytes& b) { TAUT_BYTES(a.part[i] - b.part[i]); }
// Bytes shifted by `by` bits; the bits in `keep` only.
template <int by>
inline Bytes shift_right(const Bytes& a, int keep) {
  typedef std::uint16_t Shorts __attribute__((vector_size(sizeof(BytePart))));
  Bytes r;
  for (unsigned i = 0; i < std::size(r.part); ++i)
    r.part[i] = reinterpret_cast<BytePart>(reinterpret_cast<Shorts>(a.part[i]) >> by);
  return r & splat_bytes(keep);
}
#undef TAUT_BYTES

// Bit i is set where byte i is not zero.
inline std::uint64_t nonzero(const Bytes& a) {
#if TAUT_SIMD >= 2
  const auto all = reinterpret_cast<__m512i>(a.part[0]);
  return _mm512_test_epi8_mask(all, all);
#else
  std::uint64_t m = 0;
  for (unsigned i = 0; i < std::size(a.part); ++i) {
    const auto some = reinterpret_cast<BytePart>(a.part[i] != 0);
#if TAUT_SIMD >= 1
    const auto bits = static_cast<std::uint32_t>(_mm256_movemask_epi8(reinterpret_cast<__m256i>(some)));
#elif defined(__SSE2__)
    const auto bits = static_cast<std::uint32_t>(_mm_movemask_epi8(reinterpret_cast<__m128i>(some)));
#else
    std::uint32_t bits = 0;
    for (unsigned j = 0; j < sizeof(BytePart); ++j) bits |= std::uint32_t{some[j] & 1u} << j;
#endif
    m |= std::uint64_t{bits} << (i * sizeof(BytePart));
  }
  return m;
#endif
}
// Bytes that have at least `count` bits set; others become zero.
template <int count>
inline Bytes with_bits(const Bytes& a) {
#if TAUT_SIMD >= 3
  const auto all = reinterpret_cast<__m512i>(a.part[0]);
  const __mmask64 enough = _mm512_cmpge_epu8_mask(_mm512_popcnt_epi8(all), _mm512_set1_epi8(count));
  return {{reinterpret_cast<BytePart>(_mm512_maskz_mov_epi8(enough, all))}};
#else
  const Bytes pairs = a - shift_right<1>(a, 0x55);
  const Bytes fours = (pairs & splat_bytes(0x33)) + shift_right<2>(pairs, 0x33);
  const Bytes sum = (fours + shift_right<4>(fours, 0x0f)) & splat_bytes(0x0f);
  Bytes r;
  for (unsigned i = 0; i < std::size(r.part); ++i)
    r.part[i] = a.part[i] & reinterpret_cast<BytePart>(sum.part[i] >= splat_bytes(count).part[i]);
  return r;
#endif
}

// For each eight-bit mask: how many bits are set, the places of the set bits in ascending order, and the bits
// spread over the bytes of a word (all of byte l is set where bit l is).
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
        t.spread[m] |= std::uint64_t{0xff} << (8 * l);
      }
  return t;
}();

// Stores those of the eight numbers from `base` on that the mask picks; what follows them, up to eight
// numbers, is overwritten too. Returns the end of those picked.
inline Index* store_places(Index base, unsigned mask, Index* to) {
  typedef std::uint32_t Places __attribute__((vector_size(16)));
  const std::uint32_t* const places = mask_tables.places[mask].data();
  for (int i = 0; i < lanes; i += 4) {
    const Places four = load_part<Places>(places + i) + static_cast<std::uint32_t>(base);
    std::memcpy(to + i, &four, sizeof four);
  }
  return to + mask_tables.count[mask];
}

// Stores those of the eight numbers at `from` that the mask picks; what follows them, up to eight numbers, is
// overwritten too. Returns the end of those picked.
inline Index* store_picked(const Index* from, unsigned mask, Index* to) {
#if TAUT_SIMD >= 2
  const __m256i all = load_part<__m256i>(from);
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                      _mm256_maskz_compress_epi32(static_cast<__mmask8>(mask), all));
#else
  const std::uint32_t* const places = mask_tables.places[mask].data();
  for (int i = 0; i < lanes; ++i) to[i] = from[places[i]];
#endif
  return to + mask_tables.count[mask];
}

// A pack of bytes, one a particle of consecutive words whose slices are given: appends those that `which`
// picks to `mask`, and their particles to `particle`. What follows, up to a pack of each, is overwritten too.
inline void append_picked(const Bytes& all, std::uint64_t which, const Index* slices, std::uint8_t*& mask,
                          Index*& particle) {
#if TAUT_SIMD >= 3
  static constexpr std::array<std::uint8_t, bytes> places = [] {
    std::array<std::uint8_t, bytes> p{};
    for (unsigned i = 0; i < bytes; ++i) p[i] = static_cast<std::uint8_t>(i);
    return p;
  }();
  const auto count = __builtin_popcountll(which);
  _mm512_storeu_si512(mask, _mm512_maskz_compress_epi8(which, reinterpret_cast<__m512i>(all.part[0])));
  alignas(64) std::uint8_t picked[bytes];
  const __m512i picked_places = _mm512_maskz_compress_epi8(which, load_part<__m512i>(places.data()));
  const __m512i eight = _mm512_castsi256_si512(load_part<__m256i>(slices));
  const auto particles = [&](__m128i at) {
    const __m512i place = _mm512_cvtepu8_epi32(at);
    const __m512i slice = _mm512_permutexvar_epi32(_mm512_srli_epi32(place, 3), eight);
    return _mm512_or_si512(_mm512_slli_epi32(slice, 3),
                           _mm512_and_si512(place, _mm512_set1_epi32(lanes - 1)));
  };
  _mm512_storeu_si512(particle, particles(_mm512_castsi512_si128(picked_places)));
  if (count > 16) {
    _mm512_store_si512(picked, picked_places);
    for (int i = 16; i < count; i += 16)
      _mm512_storeu_si512(particle + i, particles(load_part<__m128i>(picked + i)));
  }
  mask += count;
  particle += count;
#else
  std::uint64_t word[bytes / lanes];
  std::memcpy(word, &all, sizeof word);
  for (int w = 0; w < bytes / lanes; ++w) {
    const auto m = static_cast<unsigned>(which >> (w * lanes) & 0xff);
    particle = store_places(slices[w] * lanes, m, particle);
#if TAUT_SIMD >= 1
    const std::uint64_t picked = _pext_u64(word[w], mask_tables.spread[m]);
    std::memcpy(mask, &picked, sizeof picked);
#else
    std::uint8_t from[lanes];
    std::memcpy(from, word + w, sizeof from);
    const std::uint32_t* const places = mask_tables.places[m].data();
    for (int i = 0; i < lanes; ++i) mask[i] = from[places[i]];
#endif
    mask += mask_tables.count[m];
  }
#endif
}

// Of n numbers, those whose masks have bit l set go to out + l * stride; their counts to `count`. Sixteen
// masks and numbers are read and written at once: there is room for them, and masks beyond n are zero.
inline void deal(const Index* numbers, const std::uint8_t* masks, std::size_t n, Index* out,
                 std::size_t stride, std::size_t (&count)[lanes]) {
  Index* end[lanes];
  for (int l = 0; l < lanes; ++l) end[l] = out + static_cast<std::size_t>(l) * stride;
#if TAUT_SIMD >= 2
  for (std::size_t i = 0; i < n; i += 16) {
    const __m512i m = _mm512_cvtepu8_epi32(load_part<__m128i>(masks + i)),
                  all = load_part<__m512i>(numbers + i);
    for (int l = 0; l < lanes; ++l) {
      const __mmask16 picked = _mm512_test_epi32_mask(m, _mm512_set1_epi32(1 << l));
      _mm512_storeu_si512(end[l], _mm512_maskz_compress_epi32(picked, all));
      end[l] += __builtin_popcount(picked);
    }
  }
#else
  for (std::size_t i = 0; i < n; ++i)
    for (int l = 0; l < lanes; ++l) {  // without branches: they could not be predicted
      *end[l] = numbers[i];
      end[l] += masks[i] >> l & 1;
    }
#endif
  for (int l = 0; l < lanes; ++l)
    count[l] = static_cast<std::size_t>(end[l] - (out + static_cast<std::size_t>(l) * stride));
}

// Rows of eight numbers, `stride` apart, become columns, one after the other.
inline void transpose8(const Index* rows, std::size_t stride, Index* columns) {
#if TAUT_SIMD >= 1
  __m256 r[lanes], t[lanes];
  for (std::size_t i = 0; i < lanes; ++i) r[i] = load_part<__m256>(rows + i * stride);
  for (int i = 0; i < lanes; i += 2) {
    t[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
    t[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
  }
  for (int i = 0; i < lanes; i += 4)
    for (int j = 0; j < 2; ++j) {
      r[i + 2 * j] = _mm256_shuffle_ps(t[i + j], t[i + j + 2], 0x44);
      r[i + 2 * j + 1] = _mm256_shuffle_ps(t[i + j], t[i + j + 2], 0xee);
    }
  for (std::size_t i = 0; i < 4; ++i) {
    const __m256 low = _mm256_permute2f128_ps(r[i], r[i + 4], 0x20),
                 high = _mm256_permute2f128_ps(r[i], r[i + 4], 0x31);
    std::memcpy(columns + i * lanes, &low, sizeof low);
    std::memcpy(columns + (i + 4) * lanes, &high, sizeof high);
  }
#else
  for (std::size_t i = 0; i < lanes; ++i)
    for (std::size_t j = 0; j < lanes; ++j) columns[i * lanes + j] = rows[j * stride + i];
#endif
}

// The least and the largest of each of eight rows of eight floats. In a row NaN may only follow numbers, and
// is left out.
inline void bound_rows(const float* rows, float* least, float* largest) {
#if TAUT_SIMD >= 1
  __m256 r[lanes];
  for (int i = 0; i < lanes; ++i) r[i] = load_part<__m256>(rows + i * lanes);
  const auto fold = [&r](auto choose, float* to) {  // choose(a, b) is b where either is NaN
    __m256 halves[4], quarters[2];
    for (int i = 0; i < 4; ++i)
      halves[i] =
          choose(_mm256_permute2f128_ps(r[i], r[i + 4], 0x31), _mm256_permute2f128_ps(r[i], r[i + 4], 0x20));
    for (int i = 0; i < 2; ++i)
      quarters[i] = choose(_mm256_shuffle_ps(halves[2 * i], halves[2 * i + 1], 0xee),
                           _mm256_shuffle_ps(halves[2 * i], halves[2 * i + 1], 0x44));
    const __m256 all = choose(_mm256_shuffle_ps(quarters[0], quarters[1], 0xdd),
                              _mm256_shuffle_ps(quarters[0], quarters[1], 0x88));
    std::memcpy(to, &all, sizeof all);
  };
  fold([](__m256 a, __m256 b) { return _mm256_min_ps(a, b); }, least);
  fold([](__m256 a, __m256 b) { return _mm256_max_ps(a, b); }, largest);
#else
  for (int i = 0; i < lanes; ++i) {
    const float* const row = rows + i * lanes;
    float low = row[0], high = row[0];
    for (int l = 1; l < lanes; ++l) {
      low = row[l] < low ? row[l] : low;
      high = row[l] > high ? row[l] : high;
    }
    least[i] = low;
    largest[i] = high;
  }
#endif
}

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
