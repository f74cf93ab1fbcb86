#pragma once
/// \file
/// Packs of eight values through the compilers' vector extensions: portable to every target (g++ and clang++
/// lower them to what the processor has), no intrinsics.

#include <cstring>
#include <taut/base/types.hpp>

namespace taut {

#define TAUT_INLINE inline __attribute__((always_inline))
#define TAUT_INLINE_LAMBDA __attribute__((always_inline))

typedef double Pack __attribute__((vector_size(lanes * sizeof(double))));
typedef float PackF __attribute__((vector_size(lanes * sizeof(float))));
typedef std::int64_t PackMask __attribute__((vector_size(lanes * sizeof(std::int64_t))));

TAUT_INLINE Pack pack(double v) { return Pack{v, v, v, v, v, v, v, v}; }
TAUT_INLINE Pack load(const double* p) {
  Pack v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
TAUT_INLINE Pack load(const float* p) {
  PackF v;
  std::memcpy(&v, p, sizeof v);
  return __builtin_convertvector(v, Pack);
}
TAUT_INLINE void store(double* p, Pack v) { std::memcpy(p, &v, sizeof v); }
TAUT_INLINE Pack gather(const double* p, const Index* at) {
  return Pack{p[at[0]], p[at[1]], p[at[2]], p[at[3]], p[at[4]], p[at[5]], p[at[6]], p[at[7]]};
}

/// {before[7], v[0], …, v[6]}: values move up by a lane.
TAUT_INLINE Pack move_up(Pack before, Pack v) {
#ifdef __clang__
  return __builtin_shufflevector(before, v, 7, 8, 9, 10, 11, 12, 13, 14);
#else
  return __builtin_shuffle(before, v, PackMask{7, 8, 9, 10, 11, 12, 13, 14});
#endif
}

/// All ones in the lanes whose bits of `mask` are set.
TAUT_INLINE PackMask lanes_of(std::uint8_t mask) {
  const std::int64_t m = mask;
  return (PackMask{m, m, m, m, m, m, m, m} & PackMask{1, 2, 4, 8, 16, 32, 64, 128}) != 0;
}
/// Whether any lane is set.
TAUT_INLINE bool any(PackMask m) { return (m[0] | m[1] | m[2] | m[3] | m[4] | m[5] | m[6] | m[7]) != 0; }

}  // namespace taut
