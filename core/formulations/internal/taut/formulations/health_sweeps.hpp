#pragma once
/// \file
/// How health is measured: the parts that formulations call.

#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <taut/formulations/health.hpp>
#include <taut/kernels/kernel_table.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/operators.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

inline constexpr double told_only = std::numeric_limits<double>::infinity();

/// A measure that is flagged above `limit`; `at` is an internal index, or -1.
template <int D>
HealthMeasure measure_at(const Particles<D>& p, std::string name, double value, double limit,
                         std::string meaning, Index at);

// Of the forms on pairs in the reference configuration: two sweeps.
/// Linear exactness, spurious force of a constant stress inside and on faces, fewest neighbours, thickness.
template <int D>
void check_pair_operator(const Particles<D>& p, const PairList& pairs, const PairOperator<D>& op,
                         Health& health);
template <int D>
MotionSample pair_motion(const Particles<D>& p, const PairList& pairs, const PairOperator<D>& op);

// Of the updated forms.
/// Spurious force of a constant stress: sum_b V_a V_b 2 grad W_ab, and fewest neighbours.
template <int D>
void check_updated_operator(const Particles<D>& p, const PairList& pairs, const KernelTable& table,
                            Health& health);
/// `touching`: pairs that were adjacent at rest; `rho`: present densities, one value a particle.
template <int D>
MotionSample updated_motion(const Particles<D>& p, const std::vector<std::array<Index, 2>>& touching,
                            const Field& rho);

// What the sweeps above have in common.
/// Which particles have nothing next to them on one side: where areas are known those with some, else those
/// whose neighbours' mean is far off.
template <int D>
std::vector<std::uint8_t> on_surface(const Particles<D>& p, const PairList& pairs);
/// Forces of a unit stress: those inside, and what those on faces leave of B where that is known.
template <int D>
void add_spurious_forces(const Particles<D>& p, const std::vector<std::uint8_t>& surface, const Field& force,
                         double limit_inside, double limit_faces, Health& health);
/// Fewest neighbours, and the fewest particles across.
template <int D>
void add_neighbourhoods(const Particles<D>& p, const PairList& pairs,
                        const std::vector<std::uint8_t>& surface, Health& health);

}  // namespace taut
