#pragma once
/// \file
/// taut-compare --tolerance: the cheapest method and spacing that meet a wanted accuracy.

#include <lib/candidates.hpp>
#include <lib/common_options.hpp>
#include <lib/results.hpp>
#include <lib/scene.hpp>
#include <string>
#include <vector>

namespace taut::bench {

/// "1%" → 0.01, "0.01" → 0.01. \throws InputError unless it is a number greater than 0 and less than 1 (100
/// %).
double parse_tolerance(const std::string& text);

/// What the search found for one scene.
struct ToleranceResult {
  const Scene* scene = nullptr;
  double tolerance = 0;
  std::vector<double> pilot_dx;  ///< falling; 0 for a cloud from a file
  std::vector<Candidate> candidates;
  Truths truths;
  std::vector<std::string> notes;
  int chosen = -1;  ///< candidate that met the tolerance, or came nearest; −1: none has an error
  const Sample* best = nullptr;  ///< of it
  Prediction promised;           ///< what it was chosen for; where met
  bool met = false;              ///< verified, against a truth known better than the tolerance

  std::string verdict() const;  ///< in one sentence
  /// `pilot_`, `missed_` (a verification that did not meet the tolerance) and `chosen_` before each quantity.
  std::vector<Row> rows(int threads) const;
};

/// Pilots of all candidates, prediction, choice, and up to three verifications: one that misses counts as
/// another pilot. `say`: lines for the terminal. \throws InputError where nothing can tell an error.
ToleranceResult search(const Scene& scene, double tolerance, bool quiet);

/// Searches each scene and writes results.csv, report.html and charts/ under the output folder. \throws
/// InputError before anything is written; RunError, after everything is written, where no candidate meets the
/// tolerance.
void run_tolerance(const CommonOptions& common, const std::vector<Scene>& scenes, double tolerance);

/// report.html and its charts; what the terminal shows too. Returns what could not be drawn. \throws RunError
std::vector<std::string> write_tolerance_page(const std::vector<ToleranceResult>& results,
                                              const CommonOptions& common);
/// Candidates, their pilots, predictions and the verified choice, in plain text.
std::string plain_summary(const ToleranceResult& result);

}  // namespace taut::bench
