#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <taut/base/types.hpp>

namespace taut::detail {

// Sorts `keys` (all below 2^bits) in place, stably and in parallel, and returns where each came from:
// new keys[i] = old keys[order[i]].
template <class Key>
std::unique_ptr<Index[]> sort_by_key(std::span<Key> keys, int bits);

}  // namespace taut::detail
