#pragma once
/// \file
/// The columns of results.csv that a run of the library fills.

#include <lib/results.hpp>
#include <taut/simulation/simulation.hpp>

namespace taut::bench {

/// Particles, pairs, steps, times, memory; a run without a good end becomes `broke`: it has no value.
template <int D>
void set_run(Row& row, const Simulation<D>& simulation, const RunResult& result) {
  const auto particles = static_cast<double>(simulation.size());
  row.particles = static_cast<std::int64_t>(simulation.size());
  row.pairs = simulation.pairs();
  row.steps = result.steps;
  row.time = result.time;
  row.setup_s = simulation.setup_seconds();
  row.loop_s = result.loop_seconds;
  if (result.loop_seconds > 0)
    row.particle_steps_per_s = particles * static_cast<double>(result.steps) / result.loop_seconds;
  row.bytes_per_particle = static_cast<double>(simulation.bytes()) / particles;
  if (result.status == Status::ok) return;
  row.status = "broke";
}

}  // namespace taut::bench
