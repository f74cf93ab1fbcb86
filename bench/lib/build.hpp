#pragma once
/// \file
/// From a scene, a run and a sweep point to a simulation.

#include <lib/scene.hpp>
#include <taut/core/simulation.hpp>

namespace taut::bench {

/// The body's particles. \throws InputError at the place in the scene that is to blame.
template <int D>
Cloud<D> build_cloud(const Scene& scene, const RunSpec& run, const SweepPoint& point);

/// Body, materials, constraints and loads, ready to run. \throws InputError likewise.
template <int D>
Simulation<D> build_simulation(const Scene& scene, const RunSpec& run, const SweepPoint& point);

/// Least edge of the bounding box of a body that is a shape (not a cloud from a file) [m].
double shortest_edge(const Scene& scene);

/// The bounding box of a scene's shape, and how much of it is body (by sampling). Not for clouds from files.
struct BodySize {
  std::vector<double> edges;  ///< [m]
  double fraction = 1;
};
BodySize body_size(const Scene& scene);

/// Speed of pressure waves [m/s].
double wave_speed_of(const Scene& scene, const MaterialSpec& material);

}  // namespace taut::bench
