#pragma once
/// \file
/// Exact solutions that scenes refer to by name.

#include <functional>
#include <lib/scene.hpp>
#include <optional>

namespace taut::bench {

/// A number, or a curve in time for `measure = "curve_error"`.
struct Analytic {
  std::optional<double> value;
  std::function<double(double t)> curve;
};

std::vector<std::string> analytic_names();
/// What a name gives for a case. The documentation of each is in bench/scenes/README.md.
/// \throws InputError at the reference's place when the scene is not one the solution is for.
Analytic analytic(const Scene& scene, const RunSpec& run, const SweepPoint& point, const ProbeSpec& probe);

}  // namespace taut::bench
