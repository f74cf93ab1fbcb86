#include <doctest/doctest.h>

#include <cmath>
#include <taut/integrators/step_control.hpp>

using namespace taut;

TEST_CASE("step control: a bound that swings gives one constant step, its least value") {
  StepControl control;
  double last = 0;
  int changes = 0;
  for (int n = 0; n < 20000; ++n) {
    const double bound = 1 + 0.2 * std::cos(2 * 3.14159265358979 * (n % 37) / 37.0);
    const double step = control.next(bound);
    REQUIRE(step <= bound);
    if (n > 37) changes += step != last;
    last = step;
  }
  CHECK(changes == 0);
  CHECK(last == doctest::Approx(0.8).epsilon(0.01));
}

TEST_CASE("step control: the step falls at once and rises when the bound has stayed higher") {
  StepControl control;
  CHECK(control.next(1) == 1);
  CHECK(control.next(0.5) == 0.5);
  int waited = 0;
  while (control.next(2) == 0.5) REQUIRE(++waited < 1000);
  CHECK(waited > 100);
  CHECK(control.next(2) == 2);
  // A little is not worth a change.
  for (int n = 0; n < 2000; ++n) CHECK(control.next(2.1) == 2);
}
