// The search by cells for processors with AVX-512 and byte compression, in builds for every x86-64.
#define TAUT_SIMD 3
#include <taut/neighbors/baseline_headers.hpp>
#include <taut/neighbors/simd.hpp>

#if TAUT_SIMD_VARIANTS
#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2,avx512f,avx512vl,avx512bw,avx512dq,avx512vbmi2,avx512bitalg")
#include "search_cells_sources.hpp"
#pragma GCC pop_options
#endif
