#pragma once
/// \file
/// results.csv: one row a measured quantity, the same columns for every executable.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <taut/operators/method.hpp>
#include <vector>

namespace taut::bench {

/// One row. Empty strings and empty optionals leave their column empty.
struct Row {
  std::string scene, formulation, operators, material, kernel;
  std::optional<double> support_dx, dx;
  std::optional<std::int64_t> particles, pairs, threads;
  std::string precision, integrator;
  std::optional<std::int64_t> steps;
  std::optional<double> time;  ///< simulated [s]
  std::string quantity;
  std::optional<double> value, reference, error;
  std::string unit;
  /// ok; suspect (not to be trusted, a health_ row says why, or without a value); broke (no value; a row
  /// `breakdown_time` says when); skipped
  std::string status = "ok";
  std::optional<double> setup_s, loop_s, particle_steps_per_s, bytes_per_particle;
  std::string label;                    ///< of the run
  std::map<std::string, double> swept;  ///< values of what is swept and has no column above
};

/// Formulation, operators, kernel, support and precision; only the first where there are no pairs.
void set_method(Row& row, const Method& method);

/// "scene,formulation,…,bytes_per_particle,label" and a column for each of `swept`.
std::string results_header(const std::vector<std::string>& swept = {});
/// One line without its end. Numbers keep what it takes to read the same double back.
std::string results_line(const Row& row, const std::vector<std::string>& swept = {});
/// Value over reference less one, or their difference where `absolute` or the reference is zero.
double error_of(double value, double reference, bool absolute);
/// Replaces the file in one go, on the disk when it returns. Swept quantities of any row get a column, in the
/// order of their names. \throws RunError
void write_results(const std::filesystem::path& file, const std::vector<Row>& rows);

/// What `write_results` wrote. \throws InputError "file:line: what" for a missing file, another header, or
/// what is no number where one belongs.
std::vector<Row> read_results(const std::filesystem::path& file);

/// A swept value as part of a quantity's name, to twelve digits: 1000 → "1000", -0.5 → "minus_0_5".
std::string snake_number(double value);

}  // namespace taut::bench
