#include <omp.h>

#include <scaling/samples.hpp>
#include <scaling/stream.hpp>
#include <taut/base/simd.hpp>
#include <vector>

namespace taut::bench {

Stream::Stream(std::size_t elements) : a_(elements), b_(elements), c_(elements) {
  const auto n = static_cast<std::int64_t>(elements);
#pragma omp parallel for schedule(static)
  for (std::int64_t i = 0; i < n; ++i) {
    b_[static_cast<std::size_t>(i)] = 1;
    c_[static_cast<std::size_t>(i)] = 2;
  }
}

double Stream::triad(int threads, double least_seconds) {
  const auto n = static_cast<std::int64_t>(a_.size());
  double *a = a_.data(), *b = b_.data(), *c = c_.data();
  const double seconds = seconds_per_call(
      [&] {
#pragma omp parallel for simd schedule(static) num_threads(threads)
        for (std::int64_t i = 0; i < n; ++i) a[i] = b[i] + 0.42 * c[i];
      },
      least_seconds);
  return 3 * sizeof(double) * static_cast<double>(n) / seconds;
}

double Stream::copy(int threads, double least_seconds) {
  const auto n = static_cast<std::int64_t>(a_.size());
  double *a = a_.data(), *b = b_.data();
  // A loop that compilers do not turn into memcpy, which would write past the cache.
  const double seconds = seconds_per_call(
      [&] {
#pragma omp parallel num_threads(threads)
        {
          const int t = omp_get_thread_num(), all = omp_get_num_threads();
          const std::int64_t packs = n / lanes, first = packs * t / all, last = packs * (t + 1) / all;
          for (std::int64_t k = first; k < last; ++k) store(a + k * lanes, load(b + k * lanes) * pack(1));
        }
      },
      least_seconds);
  return 2 * sizeof(double) * static_cast<double>(n) / seconds;
}

double multiply_add_peak(int threads, double least_seconds) {
  // Enough independent chains to cover the latency of the units, few enough for the registers.
  constexpr int chains = 10;
  constexpr std::int64_t rounds = 1 << 20;
  std::vector<double> sink(static_cast<std::size_t>(threads) * lanes);
  const double seconds = seconds_per_call(
      [&] {
#pragma omp parallel num_threads(threads)
        {
          Pack sum[chains];
          for (int c = 0; c < chains; ++c) sum[c] = pack(1 + 0.01 * c);
          const Pack factor = pack(0.999999), term = pack(1e-6);
          for (std::int64_t r = 0; r < rounds; ++r)
            for (int c = 0; c < chains; ++c) sum[c] = sum[c] * factor + term;
          for (int c = 1; c < chains; ++c) sum[0] += sum[c];
          store(sink.data() + static_cast<std::ptrdiff_t>(omp_get_thread_num()) * lanes, sum[0]);
        }
      },
      least_seconds);
  volatile double kept = sink[0];
  static_cast<void>(kept);
  return 2.0 * lanes * chains * static_cast<double>(rounds) * threads / seconds;
}

}  // namespace taut::bench
