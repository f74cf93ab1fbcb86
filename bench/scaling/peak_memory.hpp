#pragma once
/// \file
/// Memory of this process, as Linux counts it.

#include <optional>

namespace taut::bench {

/// What a piece of work adds to the process' resident memory at its highest.
class PeakMemory {
 public:
  /// Gives freed memory back to the system and starts to watch.
  PeakMemory();
  /// Highest resident memory since the start less that at the start [bytes]; empty where the system does not
  /// say.
  std::optional<double> growth() const;

 private:
  std::optional<double> start_;
};

}  // namespace taut::bench
