#pragma once
// The searches by cells that this processor can run.

#include <taut/neighbors/search.hpp>
#include <taut/neighbors/slice.hpp>
#include <vector>

namespace taut::detail {

template <int D>
struct SearchVariant {
  const char* simd;  // the registers that it uses: simd.hpp
  PairList (*search)(const PointView<D>&, const Radii&);
};

// Those that this build holds, the fastest last. Their lists are the same.
template <int D>
std::vector<SearchVariant<D>> search_variants();

}  // namespace taut::detail
