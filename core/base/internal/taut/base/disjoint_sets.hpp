#pragma once
/// \file
/// What is connected with what.

#include <numeric>
#include <taut/base/types.hpp>
#include <utility>
#include <vector>

namespace taut {

/// Sets of 0 … n - 1 that are joined two by two (Tarjan 1975, with path halving; the least member stands for
/// a set).
class DisjointSets {
 public:
  explicit DisjointSets(Index n) : parent_(static_cast<std::size_t>(n)) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
  }
  void join(Index a, Index b) {
    a = find(a);
    b = find(b);
    if (a > b) std::swap(a, b);
    parent_[static_cast<std::size_t>(b)] = a;
  }
  /// Number of the set of each member, counted from 0 in the order of their least ones.
  std::vector<Index> numbers() {
    std::vector<Index> number(parent_.size());
    Index sets = 0;
    for (std::size_t i = 0; i < number.size(); ++i) {
      const Index root = find(static_cast<Index>(i));
      number[i] = root == static_cast<Index>(i) ? sets++ : number[static_cast<std::size_t>(root)];
    }
    return number;
  }

 private:
  Index find(Index i) {
    while (parent_[static_cast<std::size_t>(i)] != i) {
      Index& up = parent_[static_cast<std::size_t>(i)];
      up = parent_[static_cast<std::size_t>(up)];
      i = up;
    }
    return i;
  }
  std::vector<Index> parent_;
};

}  // namespace taut
