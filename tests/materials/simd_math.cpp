#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <taut/base/simd_math.hpp>

#include "support.hpp"

using namespace taut;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();

/// Error of pack_log in units in the last place of the exact value.
double log_error(double x) {
  double in[lanes], out[lanes];
  for (double& v : in) v = x;
  store(out, pack_log(load(in)));
  const double exact = std::log(x);
  return std::abs(out[5] - exact) / (std::nextafter(std::abs(exact), inf) - std::abs(exact));
}

template <class F>
std::array<double, lanes> map(const std::array<double, lanes>& x, F f) {
  std::array<double, lanes> y;
  store(y.data(), f(load(x.data())));
  return y;
}

}  // namespace

TEST_CASE("pack_log is within one unit in the last place of std::log") {
  double worst = 0;
  for (double x = 1e-300; x < 1e300; x *= 1.0137) worst = std::max(worst, log_error(x));
  for (double x = 0.4; x < 2.5; x += 1.7e-4) worst = std::max(worst, log_error(x));
  for (double d = 1.2e-16; d < 0.5; d *= 1.11) worst = std::max({worst, log_error(1 + d), log_error(1 - d)});
  for (const double x : {5e-324, 1e-310, 2.2250738585072009e-308, 2.2250738585072014e-308, 1.79e308})
    worst = std::max(worst, log_error(x));
  CHECK(worst <= 1);
  CHECK(log_error(1) == 0);
}

TEST_CASE("pack_log keeps its lanes apart and marks what has no logarithm") {
  const auto y =
      map({0.0, -0.0, -1, -inf, inf, std::nan(""), 2, -1e-320}, [](Pack x) { return pack_log(x); });
  for (const int nan : {0, 1, 2, 3, 5, 7}) CHECK(std::isnan(y[nan]));
  CHECK(y[4] == inf);
  CHECK(y[6] == std::log(2.0));
}

TEST_CASE("pack_log1p is accurate for small arguments") {
  double worst = 0;
  for (double d = 1e-300; d < 10; d *= 1.9)
    for (const double x : {d, -d})
      if (x > -0.99) {
        const auto y = map({x, 0, x, x, x, x, x, x}, [](Pack v) { return pack_log1p(v); });
        worst = std::max(worst, std::abs(y[7] / std::log1p(x) - 1));
        CHECK(y[1] == 0);
      }
  CHECK(worst < 5e-16);
  CHECK(std::isnan(map({-1, -2, 0, 0, 0, 0, 0, 0}, [](Pack v) { return pack_log1p(v); })[0]));
}

TEST_CASE("pack_sqrt and pack_exp_rough") {
  const auto root = map({0, 1, 2, 3, 1e300, 1e-300, -1, inf}, [](Pack v) { return pack_sqrt(v); });
  CHECK(root[2] == std::sqrt(2.0));
  CHECK(root[4] == std::sqrt(1e300));
  CHECK(std::isnan(root[6]));
  double worst = 0;
  for (double x = -600; x < 600; x += 0.37) {
    const auto y = map({x, x, x, x, x, x, x, x}, [](Pack v) { return pack_exp_rough(v); });
    worst = std::max(worst, std::abs(y[0] / std::exp(x) - 1));
  }
  CHECK(worst < 1e-4);
}
