#pragma once
/// \file
/// A body whose steps are timed, and its columns in results.csv.

#include <lib/names.hpp>
#include <optional>
#include <scaling/body.hpp>
#include <scaling/engine_step.hpp>
#include <scaling/job.hpp>
#include <scaling/traffic.hpp>
#include <string>
#include <vector>

namespace taut::bench {

struct StepSpec {
  Arrangement arrangement = Arrangement::lattice;
  int neighbours = 18;
  std::string formulation = "tl_displacement";
  PairPrecision precision = PairPrecision::automatic;  ///< total Lagrangian only
  std::vector<int> threads = {1};

  bool total() const { return !is_updated(formulation); }
};

template <int D>
class StepCase {
 public:
  /// Sets the body up. Its traffic is left out where the machine's limits are not known.
  StepCase(const Job& job, std::int64_t particles, const StepSpec& spec);

  /// "TL, lattice, 18 (17.4) neighbours, single", the mean count in brackets.
  std::string label() const;
  Contestant contestant(const Job& job, int threads);
  EngineStep<D>& engine() { return engine_; }
  const Method& method() const { return method_; }
  const StepSpec& spec() const { return spec_; }
  /// All columns but threads and what is measured.
  const Row& row() const { return row_; }
  /// Rows of what set-up took, and of the bytes and flops of a step.
  void add_setup(const Job& job) const;
  /// Rows of a measured rate, and of how near it comes to the machine's limits.
  void add_rate(const Job& job, int threads, const Samples& rate) const;

 private:
  static Method method_of(const StepSpec& spec);
  std::int64_t particles_;
  StepSpec spec_;
  Method method_;
  std::optional<double> peak_bytes_;
  EngineStep<D> engine_;
  std::optional<Traffic> traffic_;
  Row row_;
};

}  // namespace taut::bench
