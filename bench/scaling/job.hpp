#pragma once
/// \file
/// What the parts of taut-scaling share: how to measure, what is written down and said.

#include <fmt/format.h>

#include <lib/progress.hpp>
#include <lib/results.hpp>
#include <optional>
#include <scaling/body.hpp>
#include <scaling/samples.hpp>
#include <string>
#include <vector>

namespace taut::bench {

/// Measurements in progress.
struct Job {
  std::vector<std::int64_t> particles;
  std::vector<int> neighbours;
  int threads = 1;  ///< at most
  int repeats = 7;
  bool quick = false;
  double least_seconds = 0.2;  ///< of each repeat
  ProgressLine& progress;
  std::vector<Row>& rows;

  /// 1, 2, 4, … and all threads; all alone when quick.
  std::vector<int> thread_counts() const;
  /// The size that everything but the growth of N is measured at: the largest up to 10^6, or the smallest.
  std::int64_t main_particles() const;
  /// Median of a limit of the machine, `triad` or another, with that many threads; empty where it was not
  /// measured.
  std::optional<double> limit(const std::string& quantity, int threads) const;
  /// Measures the contestants in turn and says their medians and spreads, times `scale`, in `unit`.
  std::vector<Samples> measure(const std::string& title, const std::vector<Contestant>& contestants,
                               double scale, const std::string& unit) const;
  /// A row of `like` for each of QUANTITY, QUANTITY_min and QUANTITY_max.
  void add(Row like, const std::string& quantity, const Samples& samples, const std::string& unit) const;
  void add(Row like, const std::string& quantity, double value, const std::string& unit) const;
};

/// "1 thread", "2 threads".
std::string thread_label(int threads);

/// Column that describes a cube: "lattice_3d", …
template <int D>
std::string scene_name(Arrangement arrangement) {
  return fmt::format("{}_{}d", to_string(arrangement), D);
}

// The parts. Each adds its rows to the job.
void measure_machine(const Job& job);
void measure_steps(const Job& job);
void measure_baselines(const Job& job);
void measure_dense(const Job& job);
void measure_lists(const Job& job);

}  // namespace taut::bench
