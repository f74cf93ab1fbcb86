#pragma once
/// \file
/// The truth that scenes name, and what sources printed.

#include <lib/scene.hpp>

namespace taut::bench {

/// Truth for a probe; nothing where the scene has none or the table's field is empty.
/// \throws InputError for a file, column or row that is not there.
std::optional<double> reference_value(const Scene& scene, const RunSpec& run, const SweepPoint& point,
                                      const ProbeSpec& probe);

struct PrintedValue {
  std::optional<double> value;
  bool broke = false;
};
/// What a source printed; empty when it printed nothing for this point.
PrintedValue printed_value(const ProbeSpec& probe, const PrintedSpec& printed, const SweepPoint& point);

}  // namespace taut::bench
