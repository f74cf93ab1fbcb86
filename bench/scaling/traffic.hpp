#pragma once
/// \file
/// What a step must move and compute at least.

#include <taut/geometry/geometry.hpp>
#include <taut/operators/method.hpp>

namespace taut::bench {

/// Of one step, for each particle.
struct Traffic {
  double bytes = 0;
  double flops = 0;
};

/// Bytes that a step streams through memory, from the sizes of the arrays that the library makes for this
/// body: each pass over the pairs reads the list and its payload once, and each field that it needs once (all
/// reads of neighbours but the first hit a cache); each array that is written counts once, as STREAM counts.
/// The bound of the rate is the triad's bandwidth over these bytes. Flops are those of the formulas (multiply
/// and add: two; division, root and logarithm: one), empty lanes of the list left out.
template <int D>
Traffic total_lagrangian_traffic(const Cloud<D>& cloud, const Method& method);
/// The same for updated Lagrangian forms without options, whose list is rebuilt every `rebuild_every` steps:
/// a rebuild counts with what it must write.
template <int D>
Traffic updated_lagrangian_traffic(const Cloud<D>& cloud, const Method& method, int rebuild_every);

}  // namespace taut::bench
