#include <taut/neighbors/search_variants.hpp>
#include <taut/neighbors/simd.hpp>

namespace taut::detail {
namespace {

constexpr const char* names[] = {"baseline", "avx2", "avx512", "avx512_vbmi2"};

}  // namespace

inline namespace TAUT_SIMD_NAMESPACE {
template <int D>
PairList search_cells(const PointView<D>& points, const Radii& radii);
}
#if TAUT_SIMD_VARIANTS
namespace avx2 {
template <int D>
PairList search_cells(const PointView<D>& points, const Radii& radii);
}
namespace avx512_vbmi2 {
template <int D>
PairList search_cells(const PointView<D>& points, const Radii& radii);
}
#endif

template <int D>
std::vector<SearchVariant<D>> search_variants() {
  std::vector<SearchVariant<D>> all = {{names[TAUT_SIMD], &TAUT_SIMD_NAMESPACE::search_cells<D>}};
#if TAUT_SIMD_VARIANTS
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2")) {
    all.push_back({names[1], &avx2::search_cells<D>});
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vbmi2") && __builtin_cpu_supports("avx512bitalg"))
      all.push_back({names[3], &avx512_vbmi2::search_cells<D>});
  }
#endif
  return all;
}

template std::vector<SearchVariant<1>> search_variants();
template std::vector<SearchVariant<2>> search_variants();
template std::vector<SearchVariant<3>> search_variants();

}  // namespace taut::detail
