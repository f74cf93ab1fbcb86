#pragma once
/// \file
/// One number out of a history.

#include <lib/case.hpp>

namespace taut::bench {

/// Measures "peak", "arrival_time" and "curve_error" of bench/scenes/README.md, within the probe's window;
/// `exact` is needed by the last alone. Nothing when the window holds no sample.
std::optional<double> measure(const ProbeSpec& probe, const Curve& history, const Curve& exact);

}  // namespace taut::bench
