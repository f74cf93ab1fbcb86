#pragma once
// What nanoflann 1.5 calls otherwise than 1.4.

#include <cstdint>
#include <nanoflann.hpp>
#include <utility>

namespace taut::detail {

#if NANOFLANN_VERSION >= 0x150
using SearchParameters = nanoflann::SearchParameters;
template <class Id, class Distance>
using FoundPoint = nanoflann::ResultItem<Id, Distance>;
inline SearchParameters unsorted_search() { return {0.0f, false}; }
#else
using SearchParameters = nanoflann::SearchParams;
template <class Id, class Distance>
using FoundPoint = std::pair<Id, Distance>;
inline SearchParameters unsorted_search() { return {0, 0.0f, false}; }
#endif

}  // namespace taut::detail
