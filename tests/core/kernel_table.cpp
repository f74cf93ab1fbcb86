#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <taut/base/error.hpp>
#include <taut/kernels/kernel_table.hpp>

using taut::Kernel;
using taut::KernelTable;
using taut::Pack;

TEST_CASE("kernel tables follow the kernel to 1e-9") {
  for (const std::string& name : Kernel::names())
    for (int d = 1; d <= 3; ++d) {
      CAPTURE(name);
      CAPTURE(d);
      const Kernel kernel(name, d);
      const double h = 0.013, support = kernel.radius_factor() * h;
      const KernelTable table(kernel, h);
      CHECK(table.support() == support);
      double value_error = 0, slope_error = 0, value_max = 0, slope_max = 0;
      // Steps that share no factor with the intervals; lanes far apart, so that none lands in another's
      // interval.
      constexpr int steps = 7919;
      for (int i = 0; i < steps; ++i) {
        Pack r2{};
        double r[taut::lanes];
        for (int l = 0; l < taut::lanes; ++l) {
          const double s = (i + 1000.0 * l) / steps;
          r[l] = 0.2 * h + (support - 0.2 * h) * (s - std::floor(s)) + 1e-9 * h;
          r2[l] = r[l] * r[l];
        }
        const Pack value = table.value(r2), slope = table.slope_over_r(r2);
        for (int l = 0; l < taut::lanes; ++l) {
          const double w = kernel.value(r[l], h), g = kernel.derivative(r[l], h) / r[l];
          value_error = std::max(value_error, std::abs(value[l] - w));
          slope_error = std::max(slope_error, std::abs(slope[l] - g));
          value_max = std::max(value_max, std::abs(w));
          slope_max = std::max(slope_max, std::abs(g));
        }
      }
      CHECK(value_error < 1e-9 * value_max);
      CHECK(slope_error < 1e-9 * slope_max);
    }
}

TEST_CASE("kernel tables end exactly at the support and stay finite at zero") {
  for (const std::string& name : Kernel::names()) {
    CAPTURE(name);
    for (const double h : {1.0, 0.1, 1.0 / 3}) {
      const KernelTable table(Kernel(name, 2), h);
      const double s2 = table.support() * table.support();
      const double inf = std::numeric_limits<double>::infinity();
      const Pack r2{s2, std::nextafter(s2, inf), 2 * s2, 1e300, inf, std::nan(""),
                    0,  std::nextafter(s2, 0.0)};
      const Pack value = table.value(r2), slope = table.slope_over_r(r2);
      for (int l = 0; l < 6; ++l) {
        CHECK(value[l] == 0);
        CHECK(slope[l] == 0);
      }
      CHECK(value[6] == doctest::Approx(Kernel(name, 2).value(0, h)).epsilon(1e-12));
      CHECK(slope[6] < 0);
      CHECK(std::isfinite(slope[6]));
      const double last = Kernel(name, 2).value(table.support() * (1 - 1e-15), h);
      CHECK(std::abs(value[7] - last) < 1e-9 * value[6]);
    }
  }
}

TEST_CASE("kernel tables need a smoothing length") {
  const Kernel kernel("lucy", 1);
  for (const double h : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    CHECK_THROWS_AS(KernelTable(kernel, h), taut::InputError);
}
