#pragma once
/// \file
/// Methods that may meet a wanted accuracy: pilots at coarse spacings, the truth they are held against, and
/// what they predict.

#include <lib/case.hpp>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace taut::bench {

/// One candidate at one spacing, at all swept points. Points are without dx.
struct Sample {
  double dx = 0;  ///< 0 for a cloud from a file
  std::vector<CaseResult> cases;
  bool verification = false;
  std::optional<double> error;  ///< largest over points and probes; set by `judge`

  bool suspect() const;    ///< any of them
  double seconds() const;  ///< set-up and loops
  double loop_s() const;
  double work() const;   ///< sum of steps × pairs
  double steps() const;  ///< sum
};

struct Prediction {
  double dx = 0, error = 0, seconds = 0;
  std::optional<double> order;  ///< observed between the two spacings that the prediction rests on
};

struct Candidate {
  RunSpec run;
  std::vector<Sample> samples;  ///< by falling dx
  std::optional<Prediction> prediction;
  std::optional<CaseResult> broken;  ///< that which put it out
  std::string out;                   ///< why it is out, in a few words; empty while it is in
};

/// The scene's runs, then a ladder of methods on the scene's lattice without those that the runs have
/// already. Runs kept to some swept points, or, where `own_materials` is not set, with another material or
/// plane than the scene's, are left out and named in `left_out`. The ladder is labelled by method.
std::vector<Candidate> candidates_of(const Scene& scene, bool own_materials,
                                     std::vector<std::string>& left_out);

/// The swept points without dx.
std::vector<SweepPoint> points_without_dx(const Scene& scene);

/// Whether every candidate takes a probe: others cannot decide between them.
bool decides(const ProbeSpec& probe);

/// What is measured where.
using Quantity = std::pair<const ProbeSpec*, SweepPoint>;

struct Truth {
  double value = 0;
  int votes = 0;      ///< candidates whose extrapolations it is the median of; 0: the scene's reference
  double spread = 0;  ///< median distance of the votes from it, relative
};

struct Truths {
  std::map<Quantity, Truth> of;
  std::vector<std::string> untold;  ///< quantities without, and why
  double spread() const;            ///< the largest
};

/// Whether every quantity has a reference that is not zero.
bool references_suffice(const Scene& scene, const RunSpec& run);
/// References, and for quantities without one the median of the candidates' Richardson extrapolations over
/// their three finest samples: those of a candidate that tends elsewhere, or nowhere, are outvoted.
Truths truths_of(const Scene& scene, const std::vector<Candidate>& candidates);

/// Sets `error` of every sample: the largest relative error over its quantities with a truth.
void judge(Candidate& candidate, const Truths& truths);

/// The coarsest spacing at which the candidate should meet `tolerance`, from its samples: between two of them
/// by the power law through both; beyond the finest with the order of the last two, taken as at most 2,
/// aiming at 0.8 times the tolerance. `edge`: spacings are edge/n; 0 for a cloud from a file, which has one
/// spacing. `finest`: no prediction below. Sets `prediction` or `out`. Costs: pairs go with dx^-D, steps with
/// the power seen in the last two samples, seconds with the rate of the finest.
void predict(Candidate& candidate, double tolerance, double edge, double finest, int dimension);

/// The one with the least predicted seconds; null when all are out.
Candidate* cheapest(std::vector<Candidate>& candidates);

}  // namespace taut::bench
