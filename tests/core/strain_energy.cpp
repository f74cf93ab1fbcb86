#include <doctest/doctest.h>

#include <taut/base/error.hpp>
#include <taut/simulation/simulation.hpp>

using namespace taut;

namespace {

double energy_of_stretched_block(const char* material) {
  const auto cloud = make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 0.1});
  Simulation<2> simulation(cloud, make_material<2>(material, {.E = 3, .nu = 0.25, .density = 1}), {});
  simulation.set_displacement([](const Vec<2>& X) -> Vec<2> { return {1e-4 * X[0], 0}; });
  simulation.prepare();
  return simulation.strain_energy();
}

}  // namespace

TEST_CASE("strain energy of a uniformly stretched block, and of a law that has none") {
  // lambda + 2 mu = 3.6
  CHECK(energy_of_stretched_block("linear_elastic") == doctest::Approx(0.5 * 3.6 * 1e-8).epsilon(1e-6));
  CHECK(energy_of_stretched_block("neo_hookean") == doctest::Approx(0.5 * 3.6 * 1e-8).epsilon(1e-3));
  CHECK_THROWS_AS(energy_of_stretched_block("corotated_svk"), InputError);
}
