#pragma once
/// \file
/// From a scene, a run and a sweep point to a simulation.

#include <lib/scene.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/simulation/simulation.hpp>

namespace taut::bench {

/// The body's particles. \throws InputError at the place in the scene that is to blame.
template <int D>
Cloud<D> build_cloud(const Scene& scene, const RunSpec& run, const SweepPoint& point);

/// Body, materials, constraints and loads, ready to run. \throws InputError likewise.
template <int D>
Simulation<D> build_simulation(const Scene& scene, const RunSpec& run, const SweepPoint& point);

/// What the particles of the scene's file tell the rules of `auto`: whether they lie inside of the body's
/// surface, as centroids of elements do, and the support that their neighbours need. Nothing for a file that
/// cannot be read.
void add_facts_of_file(const Scene& scene, AutoFacts& facts);

/// Whether a point lies in the scene's shape (not a cloud from a file) or about `distance` [m] from it.
template <int D>
bool is_near_shape(const Scene& scene, const Vec<D>& X, double distance);

/// Least edge of the bounding box of a body that is a shape (not a cloud from a file) [m].
double shortest_edge(const Scene& scene);

/// The bounding box of a scene's shape, and how much of it is body (by sampling). Not for clouds from files.
struct BodySize {
  std::vector<double> min, edges;  ///< [m]
  double fraction = 1;
  double thickness = 0;  ///< harmonic mean of its chords along the axis where they are shortest [m]
};
BodySize body_size(const Scene& scene);

/// Speed of pressure waves [m/s].
double wave_speed_of(const Scene& scene, const MaterialSpec& material);

}  // namespace taut::bench
