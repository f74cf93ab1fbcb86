#pragma once
/// \file
/// Blocks of numbers that are alike, kept once.

#include <cstdint>
#include <taut/base/fields.hpp>
#include <taut/base/types.hpp>
#include <unordered_map>
#include <vector>

namespace taut {

/// A 128-bit hash, made from a sequence of words. Two that differ coincide once in 10^38 times.
class BlockKey {
 public:
  void add(std::uint64_t word) {
    a_ = mix(a_ ^ word, 0x9e3779b97f4a7c15);
    b_ = mix(b_ + word, 0xd1b54a32d192ed03);
  }
  bool operator==(const BlockKey&) const = default;
  struct Hash {
    std::size_t operator()(const BlockKey& k) const { return k.a_; }
  };

 private:
  static std::uint64_t mix(std::uint64_t x, std::uint64_t factor) {
    x *= factor;
    return x ^ x >> 29;
  }
  std::uint64_t a_ = 0, b_ = 0;
};

/// Gives alike items the same number and keeps one block for each number. Items are coded in chunks of fixed
/// size, each by one thread; then numbers go by first appearance, so that neither they nor the blocks depend
/// on the threads.
class BlockDictionary {
 public:
  BlockDictionary(std::size_t items, std::size_t chunks, int block)
      : block_(block), codes_(items), chunks_(chunks) {}

  /// Codes an item. `fill(double* block)` is called for a key that is new to the chunk.
  template <class Fill>
  void put(std::size_t chunk, std::size_t item, const BlockKey& key, Fill&& fill) {
    Chunk& c = chunks_[chunk];
    if (c.numbers.empty()) c.first = item;
    const auto [at, fresh] = c.numbers.try_emplace(key, static_cast<Index>(c.keys.size()));
    if (fresh) {
      c.keys.push_back(key);
      c.blocks.resize(c.blocks.size() + static_cast<std::size_t>(block_));
      fill(c.blocks.data() + c.blocks.size() - block_);
    }
    codes_[item] = at->second;
    c.last = item;
  }
  /// Hands out the code of each item and the blocks. To be called once.
  void finish(AlignedArray<Index>& codes, AlignedArray<double>& blocks);

 private:
  struct Chunk {
    std::unordered_map<BlockKey, Index, BlockKey::Hash> numbers;
    std::vector<BlockKey> keys;
    std::vector<double> blocks;
    std::size_t first = 0, last = 0;
  };
  int block_;
  AlignedArray<Index> codes_;
  std::vector<Chunk> chunks_;
};

}  // namespace taut
