#pragma once
/// \file
/// The few types that every part of taut shares.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace taut {

/// Index of a particle. 32 bits: two thousand million particles are more than one machine holds.
using Index = std::int32_t;
inline constexpr Index no_particle = -1;

/// Particles that one slice of a pair list, one pack of doubles and one step of the padding hold.
inline constexpr int lanes = 8;

template <int D>
using Vec = Eigen::Matrix<double, D, 1>;
template <int D>
using Mat = Eigen::Matrix<double, D, D>;

/// `n` rounded up to whole packs.
constexpr std::size_t padded(std::size_t n) { return (n + lanes - 1) / lanes * lanes; }

}  // namespace taut
