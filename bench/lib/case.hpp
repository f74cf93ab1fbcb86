#pragma once
/// \file
/// One case: a scene under one run at one sweep point.

#include <array>
#include <filesystem>
#include <functional>
#include <lib/results.hpp>
#include <lib/scene.hpp>
#include <optional>
#include <taut/simulation/simulation.hpp>

namespace taut::bench {

/// A sampled quantity over time.
struct Curve {
  std::vector<double> t, value;
};

struct Measured {
  const ProbeSpec* probe = nullptr;
  std::optional<double> value, reference;  ///< value: absent when the case broke, or for the reason below
  std::string why_none;                    ///< why a case that did not break gives no value; else empty
  Curve history;                           ///< dynamic cases
  Curve exact;                             ///< where the reference is a curve
};

/// The deformed body, for pictures.
struct Snapshot {
  double spacing = 0;                                 ///< of the particles, undeformed [m]
  std::vector<std::array<double, 3>> x;               ///< current positions [m]
  std::map<std::string, std::vector<double>> fields;  ///< by names of `picture_fields()` [Pa]
};

struct CaseResult {
  const Scene* scene = nullptr;
  const RunSpec* run = nullptr;
  SweepPoint point;
  std::string material;
  double dx = 0;
  std::int64_t particles = 0, pairs = 0, steps = 0;
  double time = 0, setup_s = 0, loop_s = 0, bytes = 0;
  bool broke = false;
  std::string what;       ///< broke: in a few words
  std::string where;      ///< broke: particle and its way, where one is to blame
  double broke_time = 0;  ///< [s]
  std::vector<Measured> measured;
  Health health;
  std::optional<Snapshot> snapshot;
  std::string field_error;  ///< why the fields could not be written

  double rate() const {
    return loop_s > 0 ? static_cast<double>(particles) * static_cast<double>(steps) / loop_s : 0;
  }
  /// It finished, but a measure of its health is beyond its limit.
  bool suspect() const { return !broke && health.suspect(); }
  /// Rows of results.csv: one a probe, in their order (those that this case does not take are marked
  /// skipped), then `breakdown_time` [s] where it broke, then one a measure of health. A value that is
  /// missing or not finite makes a row suspect.
  std::vector<Row> rows(int threads) const;
};

struct CaseOptions {
  std::filesystem::path field_file;  ///< .vtkhdf to write; empty: none
  bool keep_snapshot = false;
  Progress progress;
  /// Called when everything is measured, before fields are written: what took hours is kept first.
  std::function<void(const CaseResult&)> measured{};
};

/// Builds everything up to the first step and reads every probe that the run takes at some sweep point once,
/// so that a bad scene is found before any case runs: bodies that nothing holds, probes that lie more than
/// half a spacing outside of the body or have nothing to read. \throws InputError
void check_case(const Scene& scene, const RunSpec& run, const SweepPoint& point);
/// \throws Error; a formulation that breaks is a result.
CaseResult run_case(const Scene& scene, const RunSpec& run, const SweepPoint& point,
                    const CaseOptions& options);

/// The name of its files: scene, label, swept values.
std::string case_name(const Scene& scene, const RunSpec& run, const SweepPoint& point);
/// "load 3000 N, ν 0.3".
std::string describe(const SweepPoint& point);

}  // namespace taut::bench
