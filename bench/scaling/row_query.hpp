#pragma once
/// \file
/// Finding values among the rows of a job.

#include <lib/results.hpp>
#include <optional>
#include <string>
#include <vector>

namespace taut::bench {

/// Whether two rows are of the same body, method and number of threads.
bool same_case(const Row& a, const Row& b);
/// The first value of a quantity of the case that `like` is of.
std::optional<double> value_of(const std::vector<Row>& rows, const Row& like, const std::string& quantity);
/// Rows of a quantity that `wanted` accepts, the first of each case.
template <class Wanted>
std::vector<Row> cases_of(const std::vector<Row>& rows, const std::string& quantity, Wanted&& wanted) {
  std::vector<Row> found;
  for (const Row& row : rows) {
    if (row.quantity != quantity || !row.value || !wanted(row)) continue;
    bool known = false;
    for (const Row& other : found) known = known || same_case(other, row);
    if (!known) found.push_back(row);
  }
  return found;
}

/// Neighbours inside the cube that a row is of, 0 where it is of none.
int neighbours_of(const Row& row);
int dimension_of(const Row& row);
bool is_dense_case(const Row& row);  ///< of operators that are not corrected, as dense matrices are
bool is_step(const Row& row);        ///< of taut's own
/// "TL lattice, shared", "UL lattice", "csr".
std::string case_label(const Row& row);
/// The largest number of threads of all rows.
std::int64_t most_threads(const std::vector<Row>& rows);
/// Particles of the cubes that most rows of steps in 3D are of.
std::int64_t main_size(const std::vector<Row>& rows);

}  // namespace taut::bench
