#pragma once
/// \file
/// formulation = "auto": which method a run gets, by rules that are stated and reported.

#include <lib/scene.hpp>
#include <set>
#include <string>
#include <vector>

namespace taut::bench {

/// What the rules look at.
struct AutoFacts {
  bool rate_law = false;        ///< the material gives stress rates, not stresses
  bool from_file = false;       ///< the particles come from a CSV file
  bool box = false;             ///< the body is a box, whose faces a lattice meets
  bool jittered = false;        ///< particles are off the places of the lattice
  bool inside = false;          ///< particles lie inside of the surface: cell-centred lattices, centroids from a file
  bool cells = false;           ///< a node-centred lattice, jittered or not: its cells can carry the stress
  bool asks_for_pairs = false;  ///< the run gives operators, a kernel or another key that means pairs
  bool free_thickness = false;  ///< plane stress: volume may change out of plane; 1D: there is no other way
  double nu = 0;                ///< largest Poisson's ratio of the run
};
/// `given`: the keys that the run sets itself.
AutoFacts facts_of(const Scene& scene, const RunSpec& run, const std::set<std::string>& given = {});

/// Of the rules of one key the first that applies sets it. A rule without a value only says something.
struct AutoRule {
  const char* key;    ///< of [[run]]
  const char* value;  ///< as it would stand in the scene; empty: a remark
  const char* when;
  bool (*applies)(const AutoFacts&);
  const char* why;
};
const std::vector<AutoRule>& auto_rules();

/// Changes `method` as the rules say, but for the keys in `given`, which the run sets itself. Returns what
/// each rule that applied did, in the order of the rules.
std::vector<FiredRule> apply_auto_rules(const AutoFacts& facts, const std::set<std::string>& given,
                                        Method& method);

}  // namespace taut::bench
