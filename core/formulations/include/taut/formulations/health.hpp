#pragma once
/// \file
/// What a simulation can tell about its own trustworthiness.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace taut {

/// One measure of a run, its limit, and where it is worst.
struct HealthMeasure {
  std::string name;            ///< snake_case, `health_…`: the quantity of results.csv
  double value = 0;            ///< dimensionless
  double limit = 0;            ///< flagged beyond it; infinite (or minus infinite, `from_below`): only told
  bool from_below = false;     ///< flagged where the value is less than the limit, not more
  std::string meaning;         ///< one line
  std::int64_t particle = -1;  ///< the user's id of the worst one, or -1
  std::array<double, 3> X{};   ///< its reference position [m] (unused components zero)

  /// Not a number is flagged as well.
  bool flagged() const { return from_below ? !(value >= limit) : !(value <= limit); }
};

/// The measures that a formulation and a run allow, in a fixed order. Limits come from the cases of
/// bench/HEALTH.md: there every answer off by more than 10 % is flagged, and few that are off by less than 1
/// %. An answer can be wrong for reasons that no measure sees.
struct Health {
  std::vector<HealthMeasure> measures;

  /// Whether any measure is beyond its limit.
  bool suspect() const;
  /// The measure of that name, or null.
  const HealthMeasure* find(const std::string& name) const;
  /// Names and values of the flagged measures, "health_roughness 0.31 (limit 0.06)"; empty where all is well.
  std::string complaints() const;
};

/// What a formulation sees of a state: sums over the body, weighted by volume times Young's modulus, so that
/// their ratios are ratios of energies.
struct MotionSample {
  bool known = false;
  double rough = 0;            ///< sum of |x_ab - F_a X_ab|^2 / |X_ab|^2, mean over the neighbours of a
  double strain = 0;           ///< sum of |(F^T F - I) / 2|^2
  double worst = 0;            ///< largest |x_ab - F_a X_ab| / |X_ab|
  std::int32_t worst_at = -1;  ///< internal index
  double mean = 0;             ///< root of the mean square of the same
  double interface =
      -1;  ///< part of `strain` that is of particles next to another material, times (E - E') / (E + E')
  double density = -1;  ///< updated forms: rms of J from density over J from positions, less one
  double gap = -1;      ///< updated forms: largest distance of particles that touched over what F makes of it
  std::int32_t gap_at = -1;
};

}  // namespace taut
