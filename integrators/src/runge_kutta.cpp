#include <cmath>
#include <taut/integrators/runge_kutta.hpp>
#include <taut/integrators/vector_ops.hpp>
#include <utility>

namespace taut {

RungeKutta::RungeKutta(std::vector<RungeKuttaStage> stages, StepLimits limits)
    : stages_(std::move(stages)), limits_(limits) {}

void RungeKutta::advance(Dynamics& system, double t, double dt) {
  const auto blocks = system.blocks();
  if (start_.empty())
    for (const Block& block : blocks)
      start_.push_back(AlignedArray<double>::for_overwrite(block.value.size()));
  double passed = 0;  // of the step, in parts of it
  for (std::size_t i = 0; i < stages_.size(); ++i) {
    const auto& [start, last, rate] = stages_[i];
    passed = last * passed + rate;
    // Positions come first, while velocities are still those of the stage before.
    for (std::size_t b = 0; b < blocks.size(); ++b)
      if (i == 0)
        keep_and_add(start_[b], blocks[b].value, rate * dt, blocks[b].rate);
      else
        blend(blocks[b].value, start, start_[b], last, rate * dt, blocks[b].rate);
    const bool end = i + 1 == stages_.size();
    const double time = t + (end ? dt : passed * dt);
    if (end) system.constrain_positions(time);
    system.constrain_velocities(time);
    system.update(time);
  }
}

std::size_t RungeKutta::bytes() const {
  std::size_t sum = 0;
  for (const auto& block : start_) sum += block.bytes();
  return sum;
}

std::unique_ptr<Integrator> make_tvd_rk2() {
  return std::make_unique<RungeKutta>(std::vector<RungeKuttaStage>{{0, 1, 1}, {0.5, 0.5, 0.5}},
                                      step_limits(0.2));
}

std::unique_ptr<Integrator> make_ssp_rk3() {
  return std::make_unique<RungeKutta>(
      std::vector<RungeKuttaStage>{{0, 1, 1}, {0.75, 0.25, 0.25}, {1.0 / 3, 2.0 / 3, 2.0 / 3}},
      step_limits(std::sqrt(3.0)));
}

}  // namespace taut
