#pragma once
/// \file
/// Which charts the cases of a scene make.

#include <lib/case.hpp>
#include <lib/chart.hpp>
#include <vector>

namespace taut::bench {

/// Value and error against load, error against spacing, error against loop time, histories: those for which
/// the scene has numbers.
std::vector<Chart> charts_of(const Scene& scene, const std::vector<CaseResult>& cases);

/// Relative error of a quantity that all runs share (its probe is not kept to some runs or formulations);
/// nothing without a value or a truth.
std::optional<double> shared_error(const Measured& measured);
/// Root mean square of the shared errors of some cases; nothing without any.
std::optional<double> rms_error(const std::vector<const CaseResult*>& cases);

}  // namespace taut::bench
