// What a user's first program does: a body, a material, a load, an answer.
#include <cstdio>
#include <taut/taut.hpp>

int main() {
  using namespace taut;
  const auto bar = make_cloud(box<2>({0, 0}, {0.2, 0.05}), {.dx = 0.01});
  Simulation<2> simulation(bar, make_material<2>("neo_hookean", {.E = 2e6, .nu = 0.3, .density = 1000}), {});
  simulation.clamp(simulation.face("x_min"));
  simulation.load(simulation.face("x_max"), {1000, 0});
  const RunResult result = simulation.relax();
  const double stretch = simulation.displacement_at({0.2, 0.025}).x();
  std::printf("%s: the bar grows by %.3f mm\n", to_string(result.status), 1e3 * stretch);
  return result.status == Status::ok && stretch > 1e-3 && stretch < 3e-3 ? 0 : 1;
}
