#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <taut/base/error.hpp>
#include <taut/kernels/kernel.hpp>

using taut::Kernel;

namespace {

// Gauss's five-point rule on many panels that end at the knots q = 1, 2, 3: not the rule the library uses.
double integral_over_space(const Kernel& kernel, double h) {
  constexpr double node[] = {0, 0.53846931010568309, 0.90617984593866399};
  constexpr double weight[] = {128.0 / 225, 0.47862867049936647, 0.23692688505618909};
  constexpr int panels_per_h = 400;
  const double sphere[] = {2, 2 * std::numbers::pi, 4 * std::numbers::pi};
  const int d = kernel.dimension();
  const double half = h / panels_per_h / 2;
  double sum = 0;
  for (int p = 0; p < static_cast<int>(kernel.radius_factor()) * panels_per_h; ++p) {
    const double middle = (2 * p + 1) * half;
    for (int k = 0; k < 3; ++k)
      for (const double side : {-1.0, 1.0}) {
        if (k == 0 && side > 0) continue;
        const double r = middle + side * half * node[k];
        sum += weight[k] * half * kernel.value(r, h) * std::pow(r, d - 1);
      }
  }
  return sum * sphere[d - 1];
}

template <class F>
void for_all_kernels(F&& f) {
  for (const std::string& name : Kernel::names())
    for (int d = 1; d <= 3; ++d) {
      CAPTURE(name);
      CAPTURE(d);
      f(Kernel(name, d));
    }
}

}  // namespace

TEST_CASE("every kernel has unit integral, for any smoothing length") {
  for_all_kernels([](const Kernel& kernel) {
    for (const double h : {0.02, 1.0, 7.0})
      CHECK(integral_over_space(kernel, h) == doctest::Approx(1).epsilon(1e-12));
  });
}

TEST_CASE("constants agree with published ones") {
  // Monaghan 1992; Wendland 1995; the sinc^5 constant in 2D as printed by users of that kernel.
  CHECK(Kernel("cubic_spline", 3).constant() == doctest::Approx(1 / std::numbers::pi).epsilon(1e-14));
  CHECK(Kernel("wendland_c2", 2).constant() == doctest::Approx(7 / (4 * std::numbers::pi)).epsilon(1e-14));
  CHECK(Kernel("sinc5", 2).constant() == doctest::Approx(0.7103).epsilon(2e-4));
  // Computed with 30 digits.
  CHECK(Kernel("gaussian", 3).constant() == doctest::Approx(0.179666148218087177).epsilon(1e-13));
  CHECK(Kernel("mollifier", 1).constant() == doctest::Approx(2.25228362104358101).epsilon(1e-13));
  CHECK(Kernel("modified_mollifier", 2).constant() == doctest::Approx(8.74622021174746318).epsilon(1e-13));
  CHECK(Kernel("sinc5", 3).constant() == doctest::Approx(0.617012654222634393).epsilon(1e-13));
}

TEST_CASE("the derivative is that of the value") {
  for_all_kernels([](const Kernel& kernel) {
    const double h = 0.5, support = kernel.radius_factor() * h, step = 1e-5 * h;
    const double scale = kernel.value(0, h) / h;
    for (int i = 1; i < 200; ++i) {
      const double r = support * i / 200;
      CAPTURE(r);
      const double central = (kernel.value(r + step, h) - kernel.value(r - step, h)) / (2 * step);
      CHECK(std::abs(kernel.derivative(r, h) - central) < 1e-8 * scale);
    }
  });
}

TEST_CASE("the derivative of sinc5 has no cancellation near zero") {
  const Kernel kernel("sinc5", 1);
  // sinc(z)^5 = 1 - 5 z^2/6 + ..., z = pi q/2
  const double q = 1e-6, slope = -kernel.constant() * 5 * std::numbers::pi * std::numbers::pi / 12 * q;
  CHECK(kernel.derivative(q, 1) == doctest::Approx(slope).epsilon(1e-10));
  // where the series gives way to the closed form the two must meet
  const double at = 0.25 * 2 / std::numbers::pi;
  const double below = kernel.derivative(at * (1 - 1e-15), 1), above = kernel.derivative(at * (1 + 1e-15), 1);
  CHECK(below == doctest::Approx(above).epsilon(1e-13));
}

TEST_CASE("kernels are positive and fall all the way to the support") {
  for_all_kernels([](const Kernel& kernel) {
    const double h = 2, support = kernel.radius_factor() * h;
    for (int i = 0; i < 190; ++i) {
      const double r = support * i / 200, next = support * (i + 1) / 200;
      CHECK(kernel.value(r, h) > kernel.value(next, h));
      CHECK(kernel.value(next, h) > 0);
      CHECK(kernel.derivative(next, h) < 0);
    }
  });
}

TEST_CASE("outside the support a kernel is exactly zero; all but the Gaussian get there smoothly") {
  for_all_kernels([](const Kernel& kernel) {
    const double h = 0.25, support = kernel.radius_factor() * h;
    for (const double r : {support, 1.001 * support, 50 * support}) {
      CHECK(kernel.value(r, h) == 0);
      CHECK(kernel.derivative(r, h) == 0);
    }
    const double inside = support * (1 - 1e-9);
    const double value = kernel.value(inside, h) / kernel.value(0, h);
    const double slope = kernel.derivative(inside, h) * h / kernel.value(0, h);
    if (kernel.name() == "gaussian") {
      CHECK(value == doctest::Approx(std::exp(-9.0)));
    } else {
      CHECK(value < 1e-15);
      CHECK(std::abs(slope) < 2e-9);
    }
  });
}

TEST_CASE("at zero distance kernels are finite and flat, the quadratic one has a cusp") {
  for_all_kernels([](const Kernel& kernel) {
    CHECK(std::isfinite(kernel.value(0, 1)));
    const double slope = kernel.derivative(0, 1);
    CHECK(slope ==
          (kernel.name() == "quadratic" ? doctest::Approx(-0.75 * kernel.constant()) : doctest::Approx(0)));
  });
}

TEST_CASE("a NaN distance stays one") { CHECK(std::isnan(Kernel("wendland_c2", 2).value(std::nan(""), 1))); }

TEST_CASE("bad kernels are refused with the valid names") {
  CHECK_THROWS_WITH_AS(
      Kernel("cubic", 2),
      "unknown kernel \"cubic\"; valid: lucy, cubic_spline, gaussian, mollifier, modified_mollifier, "
      "quadratic, wendland_c2, sinc5",
      taut::InputError);
  CHECK_THROWS_WITH_AS(Kernel("lucy", 4), "kernel lucy: dimension 4 is not 1, 2 or 3", taut::InputError);
  CHECK_THROWS_AS(Kernel("lucy", 0), taut::InputError);
}
