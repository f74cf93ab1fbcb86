#pragma once
/// \file
/// Errors under refinement: orders, tables, charts.

#include <convergence/study.hpp>
#include <lib/extrapolation.hpp>
#include <optional>
#include <string>
#include <vector>

namespace taut::bench {

/// The mean of what is there; nothing when anything is missing.
std::optional<double> mean_of(const std::vector<std::optional<double>>& values);

/// The columns of a run's row that tell the method and the body, without what the run measured or cost.
Row shared_columns(const Row& row);

/// One method on one kind of cloud at falling spacings.
struct RefinementLine {
  std::string label;
  Row row;                                   ///< columns that its order rows share
  std::vector<std::optional<double>> error;  ///< at each spacing; nothing where it was not run or broke
  bool yardstick = false;                    ///< drawn black
  std::string suffix = {};                   ///< of the quantities of its order rows
};

/// Refinement of several methods at the same spacings.
struct Refinement {
  std::string quantity;            ///< "velocity": rows are named order_velocity and order_velocity_overall
  std::vector<double> h;           ///< spacings, falling [m]
  std::vector<std::string> names;  ///< of the spacings, for the head of a table
  std::vector<RefinementLine> lines;
};

/// Errors, the orders between successive spacings, and that between the first and the last.
TextTable order_table(const Refinement& refinement, const std::string& title, const std::string& note);
/// Rows order_QUANTITY at each spacing but the first, and order_QUANTITY_overall.
std::vector<Row> order_rows(const Refinement& refinement);
/// Error against `x` (one value a spacing), log-log, with guides of first and second order.
Chart error_chart(const Refinement& refinement, const std::vector<double>& x, Chart chart);

}  // namespace taut::bench
