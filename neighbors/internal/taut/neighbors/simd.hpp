#pragma once
// Which of the processor's registers the code of this translation unit may use. Code that depends on it lives
// in an inline namespace of that name, so that a program may hold it more than once: builds for every x86-64
// carry the search by cells for all of them and choose when they run (search_variants.hpp).

// Levels: what every x86-64 has (or no x86-64 at all), AVX2, AVX-512, and AVX-512 with byte compression.
#if defined(__AVX512F__) && defined(__AVX512VL__) && defined(__AVX512BW__) && defined(__AVX512DQ__) && \
    defined(__BMI2__)
#if defined(__AVX512VBMI2__) && defined(__AVX512BITALG__)
#define TAUT_SIMD_BUILD 3
#else
#define TAUT_SIMD_BUILD 2
#endif
#elif defined(__AVX2__) && defined(__BMI2__)
#define TAUT_SIMD_BUILD 1
#else
#define TAUT_SIMD_BUILD 0
#endif

#if !defined(TAUT_SIMD)
#define TAUT_SIMD TAUT_SIMD_BUILD
#endif

// Whether the build is to hold other levels too. Clang knows no such pragma for part of a file.
#if TAUT_SIMD_BUILD == 0 && defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
#define TAUT_SIMD_VARIANTS 1
#else
#define TAUT_SIMD_VARIANTS 0
#endif

#if TAUT_SIMD == 3
#define TAUT_SIMD_NAMESPACE avx512_vbmi2
#elif TAUT_SIMD == 2
#define TAUT_SIMD_NAMESPACE avx512
#elif TAUT_SIMD == 1
#define TAUT_SIMD_NAMESPACE avx2
#else
#define TAUT_SIMD_NAMESPACE baseline
#endif
