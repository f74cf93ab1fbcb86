#include <fmt/format.h>

#include <algorithm>
#include <scaling/row_query.hpp>
#include <scaling/summary.hpp>

namespace taut::bench {
namespace {

using Cells = std::vector<std::string>;

std::string scaled(std::optional<double> value, double scale, const char* format = "{:.3g}") {
  return value ? fmt::format(fmt::runtime(format), *value * scale) : "–";
}
std::string percent(std::optional<double> value) { return scaled(value, 100, "{:.0f} %"); }

/// "1.23 (1.1 … 1.3)".
std::string spread(const std::vector<Row>& rows, const Row& row, double scale) {
  const auto min = value_of(rows, row, row.quantity + "_min"),
             max = value_of(rows, row, row.quantity + "_max");
  return fmt::format("{} ({} … {})", scaled(row.value, scale), scaled(min, scale), scaled(max, scale));
}

Row with_threads(Row row, std::int64_t threads) {
  row.threads = threads;
  return row;
}

std::string mean_neighbours(const Row& row) {
  if (!row.pairs || !row.particles) return "–";
  return fmt::format("{:.1f}", static_cast<double>(*row.pairs) / static_cast<double>(*row.particles));
}

SummaryTable limits_table(const std::vector<Row>& rows) {
  SummaryTable t{"The machine's limits",
                 "STREAM's triad a = b + s c and copy a = b, bytes counted as STREAM counts them; "
                 "multiply-adds of packs in "
                 "registers. Medians, least … most.",
                 {"threads", "triad [GB/s]", "copy [GB/s]", "multiply-adds [Gflop/s]"},
                 {}};
  for (const Row& triad : cases_of(rows, "triad", [](const Row&) { return true; })) {
    Cells cells = {fmt::format("{}", *triad.threads)};
    for (const char* quantity : {"triad", "copy", "multiply_add_peak"}) {
      Row row = triad;
      row.quantity = quantity;
      row.value = value_of(rows, triad, quantity);
      cells.push_back(spread(rows, row, 1e-9));
    }
    t.rows.push_back(std::move(cells));
  }
  return t;
}

SummaryTable steps_table(const std::vector<Row>& rows) {
  const std::int64_t threads = most_threads(rows), size = main_size(rows);
  SummaryTable t{
      fmt::format("Steps of {} particles in 3D", size),
      "Million particle-steps a second, medians (least … most). The bound is the triad's bandwidth over the "
      "bytes that a step must stream a particle; flops: the fraction of the machine's multiply-adds. "
      "Payload: how the pair vectors are "
      "kept. Updated Lagrangian rates include a rebuild of the list in every tenth step.",
      {"case", "neighbours (mean)", "1 thread", fmt::format("{} threads", threads), "speed-up",
       "bytes a step", "bound", "fraction of limit", "of peak flops", "bytes kept a particle"},
      {}};
  for (const Row& row : cases_of(rows, "rate", [&](const Row& r) {
         return is_step(r) && dimension_of(r) == 3 && r.particles == size && r.threads == threads;
       })) {
    const Row one = with_threads(row, 1);
    t.rows.push_back({case_label(row), fmt::format("{} ({})", neighbours_of(row), mean_neighbours(row)),
                      scaled(value_of(rows, one, "rate"), 1e-6), spread(rows, row, 1e-6),
                      scaled(value_of(rows, row, "ratio_to_one_thread"), 1, "{:.2f}"),
                      scaled(value_of(rows, row, "bytes_per_step"), 1, "{:.0f}"),
                      scaled(value_of(rows, row, "bound_rate"), 1e-6),
                      percent(value_of(rows, row, "fraction_of_limit")),
                      percent(value_of(rows, row, "fraction_of_peak_flops")),
                      scaled(row.bytes_per_particle, 1, "{:.0f}")});
  }
  std::stable_sort(t.rows.begin(), t.rows.end(), [](const Cells& a, const Cells& b) { return a[0] < b[0]; });
  return t;
}

SummaryTable baselines_table(const std::vector<Row>& rows) {
  SummaryTable t{
      "Against other ways to write the same step",
      "Total Lagrangian, neo-Hookean, corrected operator, measured in turn in one run. CSR: compressed rows, "
      "a gradient "
      "a pair, small Eigen vectors and matrices, OpenMP. Eigen: products of three row-major sparse matrices "
      "with three columns. "
      "Both work in double precision and give the accelerations of taut to 1e-10 (checked in the run).",
      {"case", "neighbours", "threads", "taut [M/s]", "CSR [M/s]", "Eigen [M/s]", "ratio to CSR",
       "ratio to Eigen"},
      {}};
  for (const Row& row : cases_of(rows, "ratio_to_csr", [](const Row&) { return true; })) {
    const auto eigen = value_of(rows, row, "ratio_to_eigen");
    const double rate = row.particle_steps_per_s.value_or(0);
    t.rows.push_back({case_label(row), fmt::format("{}", neighbours_of(row)), fmt::format("{}", *row.threads),
                      scaled(rate, 1e-6), scaled(rate / *row.value, 1e-6),
                      eigen ? scaled(rate / *eigen, 1e-6) : "–", scaled(row.value, 1, "{:.1f}"),
                      scaled(eigen, 1, "{:.1f}")});
  }
  return t;
}

SummaryTable sizes_table(const std::vector<Row>& rows) {
  SummaryTable t{"Set-up and memory",
                 "Kept: arrays of the simulation. Peak: what set-up and the first step add to the resident "
                 "memory of the "
                 "process at its highest, the cloud that the user gave included.",
                 {"case", "neighbours", "particles", "set-up [s]", "kept [B/particle]", "peak [B/particle]",
                  "peak [GiB]"},
                 {}};
  for (const Row& row : cases_of(rows, "setup", [](const Row& r) { return dimension_of(r) == 3; })) {
    const auto peak = value_of(rows, row, "peak_bytes_per_particle");
    t.rows.push_back(
        {case_label(row), fmt::format("{}", neighbours_of(row)), fmt::format("{}", *row.particles),
         scaled(row.value, 1), scaled(row.bytes_per_particle, 1, "{:.0f}"), scaled(peak, 1, "{:.0f}"),
         peak ? scaled(*peak * static_cast<double>(*row.particles) / (1 << 30), 1, "{:.2f}") : "–"});
  }
  return t;
}

SummaryTable growth_table(const std::vector<Row>& rows) {
  const std::int64_t threads = most_threads(rows), size = main_size(rows);
  SummaryTable t{"Other numbers of particles and dimensions",
                 fmt::format("{} threads.", threads),
                 {"case", "dimensions", "neighbours", "particles", "M particle-steps/s", "fraction of limit"},
                 {}};
  for (const Row& row : cases_of(rows, "rate", [&](const Row& r) {
         return is_step(r) && r.threads == threads && (dimension_of(r) != 3 || r.particles != size);
       }))
    t.rows.push_back({case_label(row), fmt::format("{}", dimension_of(row)),
                      fmt::format("{}", neighbours_of(row)), fmt::format("{}", *row.particles),
                      spread(rows, row, 1e-6), percent(value_of(rows, row, "fraction_of_limit"))});
  return t;
}

SummaryTable dense_table(const std::vector<Row>& rows) {
  SummaryTable t{
      "Dense matrices",
      "The dense-matrix algorithm of the University of Cape Town thesis behind E. B. Ismail and B. D. Reddy, "
      "\"Smoothed particle hydrodynamics for nonlinear solid mechanics\": every sum over pairs is a product "
      "with a full matrix. The same "
      "operator "
      "(`standard`) in both; accelerations agree to 1e-10 (checked in the run).",
      {"dimensions", "particles", "taut [M/s]", "dense [M/s]", "ratio", "dense matrices [B/particle]"},
      {}};
  for (const Row& row : cases_of(rows, "ratio_to_dense", [](const Row&) { return true; })) {
    Row dense = row;
    dense.formulation = "baseline_dense";
    const auto found =
        std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return same_case(r, dense); });
    t.rows.push_back({fmt::format("{}", dimension_of(row)), fmt::format("{}", *row.particles),
                      scaled(row.particle_steps_per_s, 1e-6),
                      scaled(row.particle_steps_per_s.value_or(0) / *row.value, 1e-6), scaled(row.value, 1),
                      found == rows.end() ? "–" : scaled(found->bytes_per_particle, 1, "{:.0f}")});
  }
  return t;
}

SummaryTable lists_table(const std::vector<Row>& rows) {
  SummaryTable t{"Pair lists against nanoflann's radiusSearch",
                 "Milliseconds for all lists, tree or cells included, on points in order of locality; "
                 "nanoflann in an OpenMP loop over points, not "
                 "sorted, lists kept. Graded: spacing and radius grow fourfold along x; there each of "
                 "nanoflann's lists ends at its own "
                 "point's radius, taut's pairs at the larger of two. Numbers of pairs are equal otherwise "
                 "(checked in the run).",
                 {"points", "number", "neighbours (mean)", "threads", "taut [ms]", "nanoflann [ms]", "ratio"},
                 {}};
  for (const Row& row : cases_of(rows, "ratio_to_nanoflann", [](const Row&) { return true; })) {
    Row ours = row, theirs = row;
    ours.quantity = theirs.quantity = "list_seconds";
    theirs.formulation = "list_nanoflann";
    ours.value = value_of(rows, ours, "list_seconds");
    theirs.value = value_of(rows, theirs, "list_seconds");
    t.rows.push_back({row.scene.substr(0, row.scene.find('_')), fmt::format("{}", *row.particles),
                      mean_neighbours(row), fmt::format("{}", *row.threads), spread(rows, ours, 1e3),
                      spread(rows, theirs, 1e3), scaled(row.value, 1, "{:.1f}")});
  }
  return t;
}

}  // namespace

std::vector<SummaryTable> scaling_tables(const std::vector<Row>& rows) {
  std::vector<SummaryTable> tables = {limits_table(rows), steps_table(rows), baselines_table(rows),
                                      growth_table(rows), sizes_table(rows), dense_table(rows),
                                      lists_table(rows)};
  std::erase_if(tables, [](const SummaryTable& t) { return t.rows.empty(); });
  return tables;
}

}  // namespace taut::bench
