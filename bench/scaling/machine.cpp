#include <scaling/job.hpp>
#include <scaling/stream.hpp>

namespace taut::bench {

void measure_machine(const Job& job) {
  Stream stream;
  std::vector<Contestant> bandwidths, peaks;
  std::vector<std::pair<const char*, int>> what;
  for (const int t : job.thread_counts()) {
    bandwidths.push_back(
        {"triad, " + thread_label(t), [&, t] { return stream.triad(t, job.least_seconds); }});
    what.emplace_back("triad", t);
    bandwidths.push_back({"copy, " + thread_label(t), [&, t] { return stream.copy(t, job.least_seconds); }});
    what.emplace_back("copy", t);
    peaks.push_back(
        {"multiply-adds, " + thread_label(t), [&, t] { return multiply_add_peak(t, job.least_seconds); }});
  }
  const auto row = [](int threads) {
    Row r;
    r.scene = "machine";
    r.threads = threads;
    return r;
  };
  const auto measured = job.measure("Memory bandwidth", bandwidths, 1e-9, "GB/s");
  for (std::size_t k = 0; k < what.size(); ++k)
    job.add(row(what[k].second), what[k].first, measured[k], "B/s");
  const auto flops = job.measure("Arithmetic", peaks, 1e-9, "Gflop/s");
  for (std::size_t k = 0; k < flops.size(); ++k)
    job.add(row(job.thread_counts()[k]), "multiply_add_peak", flops[k], "flop/s");
}

}  // namespace taut::bench
