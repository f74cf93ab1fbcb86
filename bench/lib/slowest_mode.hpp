#pragma once
/// \file
/// How slowly a body swings, from its bounding box and what holds it: what a relaxation has to wait for.

#include <lib/build.hpp>
#include <lib/scene.hpp>

namespace taut::bench {

/// Period of the slowest motion that the scene's loads excite [s], roughly: bars, beams with shear, and
/// plates that are held at the ends where boundaries select them; of bodies much thinner than their bounding
/// box the bending of their walls. \throws InputError for a material that cannot be made
double slowest_period(const Scene& scene, const RunSpec& run, const SweepPoint& point, const BodySize& body);

}  // namespace taut::bench
