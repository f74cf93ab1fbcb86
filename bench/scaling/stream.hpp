#pragma once
/// \file
/// What the machine can do at most: bandwidth of memory, rate of arithmetic.

#include <taut/base/fields.hpp>

namespace taut::bench {

/// STREAM (McCalpin 1995): bandwidth of memory, on arrays that no cache holds. Bytes count as STREAM counts
/// them, each read and each write once: that a processor reads a line before it writes it is left out.
class Stream {
 public:
  explicit Stream(std::size_t elements = std::size_t{1} << 25);
  /// a = b + s c [bytes/s].
  double triad(int threads, double least_seconds);
  /// a = b [bytes/s].
  double copy(int threads, double least_seconds);

 private:
  AlignedArray<double> a_, b_, c_;
};

/// Double-precision multiply-adds of packs in registers [flop/s]: what this build's vector width can reach.
double multiply_add_peak(int threads, double least_seconds);

}  // namespace taut::bench
