#pragma once
/// \file
/// The Pareto front of points (cost, error).

#include <cstddef>
#include <vector>

namespace taut::bench {

/// Indices of the points than which no other is better in one of cost and error and as good in the other, by
/// rising cost. Of equal points the first. Both vectors have the same length; values that are not finite are
/// left out.
std::vector<std::size_t> pareto_front(const std::vector<double>& cost, const std::vector<double>& error);

}  // namespace taut::bench
