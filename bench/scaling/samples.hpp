#pragma once
/// \file
/// Repeated measurements whose order is fair.

#include <functional>
#include <string>
#include <vector>

namespace taut::bench {

/// What repeats of one measurement gave.
class Samples {
 public:
  void add(double value) { values_.push_back(value); }
  std::size_t size() const { return values_.size(); }
  double median() const;
  double min() const;
  double max() const;

 private:
  std::vector<double> values_;
};

/// One thing that is measured against others: `measure` runs it once, long enough to be timed, and gives the
/// value of that repeat.
struct Contestant {
  std::string label;
  std::function<double()> measure;
};

/// Measures all contestants in turn, `repeats` times over, every second round in the reverse order: what
/// drifts on the machine meets all of them alike. `tick` is called after each measurement.
std::vector<Samples> alternate(const std::vector<Contestant>& contestants, int repeats,
                               const std::function<void()>& tick = {});

/// Seconds that one call of `work` takes: calls it until `least_seconds` have passed.
double seconds_per_call(const std::function<void()>& work, double least_seconds);

}  // namespace taut::bench
