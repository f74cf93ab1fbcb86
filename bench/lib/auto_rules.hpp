#pragma once
/// \file
/// formulation = "auto" in a scene: what the library's rules look at.

#include <lib/scene.hpp>
#include <set>
#include <string>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {

/// `given`: the keys that the run sets itself.
AutoFacts facts_of(const Scene& scene, const RunSpec& run, const std::set<std::string>& given = {});

}  // namespace taut::bench
