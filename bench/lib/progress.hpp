#pragma once
/// \file
/// What a job says while it runs.

#include <chrono>
#include <cstdint>
#include <string>

namespace taut::bench {

/// On a terminal one line that is kept up to date, elsewhere one plain line an item. Writes to standard
/// output; silent when quiet.
class ProgressLine {
 public:
  ProgressLine(bool quiet, std::size_t items);

  /// Begins item number `item` (from 0).
  void begin(std::size_t item, const std::string& what);
  /// Work done so far in this item, fraction 0 … 1.
  void update(std::int64_t steps, double fraction);
  /// Ends the item with a line that stays.
  void end(const std::string& outcome);
  /// A line that stays, between items.
  void say(const std::string& line);

 private:
  bool quiet_, terminal_;
  std::size_t items_, item_ = 0;
  std::string what_;
  std::chrono::steady_clock::time_point last_{};
};

}  // namespace taut::bench
