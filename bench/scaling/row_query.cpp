#include <algorithm>
#include <cmath>
#include <lib/names.hpp>
#include <map>
#include <scaling/body.hpp>
#include <scaling/row_query.hpp>

namespace taut::bench {
namespace {

template <int D>
int neighbours_in(const Row& row) {
  const auto arrangement = row.scene.starts_with("jittered") ? Arrangement::jittered : Arrangement::lattice;
  for (const Neighbourhood& hood : neighbourhoods<D>(arrangement))
    if (row.support_dx && std::abs(hood.support_dx - *row.support_dx) < 1e-9) return hood.neighbours;
  return 0;
}

}  // namespace

bool same_case(const Row& a, const Row& b) {
  return a.scene == b.scene && a.formulation == b.formulation && a.operators == b.operators &&
         a.precision == b.precision && a.support_dx == b.support_dx && a.particles == b.particles &&
         a.threads == b.threads;
}

std::optional<double> value_of(const std::vector<Row>& rows, const Row& like, const std::string& quantity) {
  for (const Row& row : rows)
    if (row.quantity == quantity && same_case(row, like)) return row.value;
  return {};
}

int dimension_of(const Row& row) {
  return row.scene.ends_with("_1d") ? 1 : row.scene.ends_with("_2d") ? 2 : row.scene.ends_with("_3d") ? 3 : 0;
}

int neighbours_of(const Row& row) {
  switch (dimension_of(row)) {
    case 1:
      return neighbours_in<1>(row);
    case 2:
      return neighbours_in<2>(row);
    case 3:
      return neighbours_in<3>(row);
    default:
      return 0;
  }
}

bool is_dense_case(const Row& row) { return exactness(row.operators) == 0; }

bool is_step(const Row& row) {
  return !is_dense_case(row) && formulation_registry().look_up(row.formulation);
}

std::string case_label(const Row& row) {
  if (row.formulation == "baseline_csr") return "plain CSR gather";
  if (row.formulation == "baseline_eigen") return "Eigen sparse products";
  if (row.formulation == "baseline_dense") return "dense matrices";
  const std::string cloud = row.scene.substr(0, row.scene.find('_'));
  if (is_updated(row.formulation)) return "UL " + cloud;
  return "TL " + cloud + ", " + row.precision;
}

std::int64_t most_threads(const std::vector<Row>& rows) {
  std::int64_t most = 1;
  for (const Row& row : rows) most = std::max(most, row.threads.value_or(1));
  return most;
}

std::int64_t main_size(const std::vector<Row>& rows) {
  std::map<std::int64_t, int> count;
  for (const Row& row : rows)
    if (row.quantity == "rate" && dimension_of(row) == 3 && is_step(row) && row.particles)
      ++count[*row.particles];
  std::int64_t size = 0;
  for (const auto& [particles, times] : count)
    if (size == 0 || times >= count[size]) size = particles;
  return size;
}

}  // namespace taut::bench
