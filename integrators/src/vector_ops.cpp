#include <algorithm>
#include <cstdint>
#include <taut/integrators/vector_ops.hpp>
#include <vector>

namespace taut {

namespace {
constexpr std::int64_t block = 4096;
constexpr std::int64_t parallel_from = 16 * block;
std::int64_t blocks_of(std::size_t n) { return (static_cast<std::int64_t>(n) + block - 1) / block; }
}  // namespace

void add_scaled(std::span<double> y, double factor, std::span<const double> x) {
  const auto n = static_cast<std::int64_t>(y.size());
  double* ys = y.data();
  const double* xs = x.data();
#pragma omp parallel for simd schedule(static) if (n > parallel_from)
  for (std::int64_t i = 0; i < n; ++i) ys[i] += factor * xs[i];
}

void kick_drift(std::span<double> x, std::span<double> v, std::span<const double> a, double kick,
                double drift) {
  const auto n = static_cast<std::int64_t>(x.size());
  double* xs = x.data();
  double* vs = v.data();
  const double* as = a.data();
#pragma omp parallel for simd schedule(static) if (n > parallel_from)
  for (std::int64_t i = 0; i < n; ++i) {
    vs[i] += kick * as[i];
    xs[i] += drift * vs[i];
  }
}

void kick_kick_drift(std::span<double> x, std::span<double> v, std::span<const double> a, double first,
                     double second, double drift) {
  const auto n = static_cast<std::int64_t>(x.size());
  double* xs = x.data();
  double* vs = v.data();
  const double* as = a.data();
#pragma omp parallel for simd schedule(static) if (n > parallel_from)
  for (std::int64_t i = 0; i < n; ++i) {
    vs[i] += first * as[i];
    vs[i] += second * as[i];
    xs[i] += drift * vs[i];
  }
}

void keep_and_add(std::span<double> start, std::span<double> y, double factor, std::span<const double> x) {
  const auto n = static_cast<std::int64_t>(y.size());
  double *ys = y.data(), *kept = start.data();
  const double* xs = x.data();
#pragma omp parallel for simd schedule(static) if (n > parallel_from)
  for (std::int64_t i = 0; i < n; ++i) {
    kept[i] = ys[i];
    ys[i] += factor * xs[i];
  }
}

void blend(std::span<double> y, double of_start, std::span<const double> start, double of_y, double factor,
           std::span<const double> x) {
  const auto n = static_cast<std::int64_t>(y.size());
  double* ys = y.data();
  const double *kept = start.data(), *xs = x.data();
#pragma omp parallel for simd schedule(static) if (n > parallel_from)
  for (std::int64_t i = 0; i < n; ++i) ys[i] = of_start * kept[i] + (of_y * ys[i] + factor * xs[i]);
}

namespace {
// Sum of term(i) for i < n, block by block.
template <class Term>
double sum_of(std::size_t n, Term&& term) {
  const std::int64_t blocks = blocks_of(n);
  std::vector<double> partial(static_cast<std::size_t>(blocks));
#pragma omp parallel for schedule(static) if (blocks > 16)
  for (std::int64_t b = 0; b < blocks; ++b) {
    const std::size_t end = std::min(n, static_cast<std::size_t>((b + 1) * block));
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = static_cast<std::size_t>(b * block); i < end; ++i) sum += term(i);
    partial[static_cast<std::size_t>(b)] = sum;
  }
  double sum = 0;
  for (const double p : partial) sum += p;
  return sum;
}
}  // namespace

double dot(std::span<const double> x, std::span<const double> y) {
  return sum_of(x.size(), [xs = x.data(), ys = y.data()](std::size_t i) { return xs[i] * ys[i]; });
}

double weighted_dot(std::span<const double> weight, std::span<const double> x, std::span<const double> y) {
  return sum_of(x.size(), [w = weight.data(), xs = x.data(), ys = y.data()](std::size_t i) {
    return w[i] * xs[i] * ys[i];
  });
}

}  // namespace taut
