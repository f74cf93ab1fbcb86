#pragma once
/// \file
/// formulation = "auto": which method a body gets, by rules that are stated and reported.

#include <set>
#include <string>
#include <taut/geometry/geometry.hpp>
#include <taut/materials/material.hpp>
#include <taut/operators/method.hpp>
#include <vector>

namespace taut {

/// What the rules look at.
struct AutoFacts {
  bool rate_law = false;  ///< the material gives stress rates, not stresses
  bool cells = false;     ///< a node-centred lattice, jittered or not: its cells can carry the stress
  bool inside = false;  ///< particles lie inside of the surface: cell-centred lattices, centroids from a file
  bool asks_for_pairs = false;  ///< operators, a kernel or another key that means pairs is given
  bool free_thickness = false;  ///< plane stress: volume may change out of plane; 1D: there is no other way
  double nu = 0;                ///< largest Poisson's ratio
  double support = 1.5;         ///< that the neighbours of irregular clouds need, as `spanning_support` tells
};

/// Of the rules of one key the first that applies sets it. A rule without a value only says something.
struct AutoRule {
  const char* key;    ///< of a method, as scenes have it
  const char* value;  ///< as it would stand in a scene; empty: a remark
  const char* when;
  bool (*applies)(const AutoFacts&);
  const char* why;
};
const std::vector<AutoRule>& auto_rules();

/// What a rule did.
struct FiredRule {
  std::string sets;  ///< "operators = compatible"; empty: a remark
  std::string when, why;
};

/// Keys of a method that mean pairs.
const std::vector<std::string>& pair_keys();

/// Changes `method` as the rules say, but for the keys in `given`. Returns what each rule that applied did,
/// in the order of the rules.
std::vector<FiredRule> apply_auto_rules(const AutoFacts& facts, const std::set<std::string>& given,
                                        Method& method);

/// Whether particles lie inside of the body's surface: a mean depth under their facets of more than 0.15
/// spacings. Finds the facets where the cloud brings neither these nor areas; false where that fails.
template <int D>
bool lies_inside(const Cloud<D>& cloud);

/// The least of the supports 1.5, 1.7, 2, 2.4 and 2.8, over the spacing of a particle or the wider one of a
/// pair, within which the neighbours of every particle span the space: weighted by (1 - r / R)^2 their second
/// moments have no eigenvalue below 0.015 of the sum of all. Where they hardly do, operators weigh few
/// neighbours by large numbers, and a single particle shortens the steps of all. 1.5 for lattices, and where
/// none of them is enough.
template <int D>
double spanning_support(const Cloud<D>& cloud);

/// The method with what it leaves open filled in: by the rules where it leaves all of it open; else what
/// names no formulation is `tl_displacement`, and `corrected` operators, the kernel `wendland_c2` and the
/// support that formulation and operators take at least (their traits) stand for those that are not given.
template <int D>
Method complete(const Method& method, const Cloud<D>& cloud, const Material<D>& material);
/// The same without a body.
Method with_defaults(Method method);

}  // namespace taut
