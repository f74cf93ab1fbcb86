// The stable step bounds the highest frequency of the discrete body, whatever the operators, the cloud and
// Poisson's ratio: that of a scalar medium alone is 27 % too low for compatible operators at 2.4 dx where nu
// is 0.49.
#include <doctest/doctest.h>

#include "discretised.hpp"

using namespace taut;

namespace {

template <int D>
auto neo_hookean(double nu) {
  return make_material<D>("neo_hookean", {.E = 1e6, .nu = nu, .density = 1000});
}

template <int D>
constexpr int spacings = D == 2 ? 10 : 5;

}  // namespace

TEST_CASE_TEMPLATE("stable step: leapfrog stays bounded on pairs", Dimension, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const char* operators : {"corrected", "compatible", "antisymmetric"})
    for (const double support : {1.5, 2.4})
      for (const double jitter : {0.0, 0.3})
        for (const double nu : {0.3, 0.49}) {
          CAPTURE(operators);
          CAPTURE(support);
          CAPTURE(jitter);
          CAPTURE(nu);
          check_stable_step(brick<D>(spacings<D>, jitter), neo_hookean<D>(nu),
                            {.operators = operators, .support_dx = support});
        }
}

TEST_CASE_TEMPLATE("stable step: leapfrog stays bounded on stress points", Dimension, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double jitter : {0.0, 0.3})
    for (const double nu : {0.3, 0.49, 0.499}) {
      CAPTURE(jitter);
      CAPTURE(nu);
      const auto cloud = make_cloud(box<D>(Vec<D>::Zero(), Vec<D>::Ones()),
                                    {.dx = 1.0 / spacings<D>, .jitter = jitter, .seed = 7, .cells = true});
      check_stable_step(cloud, neo_hookean<D>(nu), {.formulation = "tl_stress_points"});
    }
}
