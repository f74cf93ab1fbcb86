#pragma once
// How far apart the points of a cloud are.

#include <taut/base/types.hpp>
#include <vector>

namespace taut {

/// Distance of each point to its k-th nearest other one, k at least 1; infinite where there are fewer.
template <int D>
std::vector<double> nearest_distances(const std::vector<Vec<D>>& X, int k);

/// The k points nearest to each, itself included, near ones first: k entries a point, no_particle where there
/// are fewer.
template <int D>
std::vector<Index> nearest_points(const std::vector<Vec<D>>& X, int k);

/// The median distance to the nearest other point; infinite for a single one.
template <int D>
double median_distance(const std::vector<Vec<D>>& X);

/// V^(1/D) in the middle of the volume: half of sum V lies in particles that are larger. Half volumes on
/// faces do not count for much in it.
double spacing_by_volume(std::vector<double> V, int dimension);

}  // namespace taut
