#pragma once
#include <taut/neighbors/slice.hpp>

namespace taut::detail {

// \throws InputError for the first coordinate that is not finite.
template <int D>
void check_points(const PointView<D>& points);
// \throws InputError for the first radius that cannot be one.
void check_radii(const Radii& radii, Index particles);
// Throws the InputError for particle a and the first that lies on it.
template <int D>
[[noreturn]] void throw_coincident(const PointView<D>& points, const Radii& radii, Index a);

}  // namespace taut::detail
