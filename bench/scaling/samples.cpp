#include <algorithm>
#include <chrono>
#include <scaling/samples.hpp>

namespace taut::bench {

double Samples::median() const {
  std::vector<double> sorted = values_;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t n = sorted.size();
  return n % 2 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}
double Samples::min() const { return *std::min_element(values_.begin(), values_.end()); }
double Samples::max() const { return *std::max_element(values_.begin(), values_.end()); }

std::vector<Samples> alternate(const std::vector<Contestant>& contestants, int repeats,
                               const std::function<void()>& tick) {
  std::vector<Samples> samples(contestants.size());
  for (int r = 0; r < repeats; ++r)
    for (std::size_t k = 0; k < contestants.size(); ++k) {
      const std::size_t c = r % 2 ? contestants.size() - 1 - k : k;
      samples[c].add(contestants[c].measure());
      if (tick) tick();
    }
  return samples;
}

double seconds_per_call(const std::function<void()>& work, double least_seconds) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  double seconds = 0;
  int calls = 0;
  do {
    work();
    ++calls;
    seconds = std::chrono::duration<double>(Clock::now() - start).count();
  } while (seconds < least_seconds);
  return seconds / calls;
}

}  // namespace taut::bench
