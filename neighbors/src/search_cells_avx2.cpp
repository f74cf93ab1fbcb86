// The search by cells for processors with AVX2, in builds for every x86-64.
#define TAUT_SIMD 1
#include <taut/neighbors/baseline_headers.hpp>
#include <taut/neighbors/simd.hpp>

#if TAUT_SIMD_VARIANTS
#pragma GCC push_options
#pragma GCC target("avx2,bmi,bmi2")
#include "search_cells_sources.hpp"
#pragma GCC pop_options
#endif
