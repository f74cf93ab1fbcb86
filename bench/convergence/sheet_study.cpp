#include <fmt/format.h>

#include <cmath>
#include <convergence/kirsch.hpp>
#include <convergence/refinement.hpp>
#include <convergence/run_row.hpp>
#include <lib/names.hpp>
#include <lib/progress.hpp>
#include <taut/base/error.hpp>
#include <taut/base/small_solve.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/simulation/simulation.hpp>

namespace taut::bench {
namespace {

constexpr double hole = 0.01, outside = 0.05;  // radii [m]

KirschPlate plate() { return {hole, 5e3, {.E = 70e6, .nu = 0.49, .density = 1000, .plane = Plane::stress}}; }

struct Outcome {
  Row row;
  std::optional<double> peak, stress_error;
  std::string why;  ///< skipped
};

Outcome run_sheet(const Method& method, bool fitted, double dx, int threads) {
  const KirschPlate exact = plate();
  const Cloud<2> cloud =
      fitted ? quarter_ring_cloud(hole, outside, dx) : quarter_ring_lattice(hole, outside, dx);
  Simulation<2> simulation(cloud, make_material<2>("linear_elastic", exact.material), method);
  simulation.symmetry_plane(0, 0);
  simulation.symmetry_plane(1, 0);
  const auto rim = [&](const Vec<2>& X) { return X.norm() > outside - (fitted ? 0.5 : std::sqrt(2.0)) * dx; };
  for (int axis = 0; axis < 2; ++axis)
    simulation.prescribe(rim, axis,
                         [exact, axis](const Vec<2>& X, double) { return exact.displacement(X)[axis]; });
  Outcome outcome;
  Row& row = outcome.row;
  row.scene = fitted ? "sheet_with_hole_fitted" : "sheet_with_hole_lattice";
  set_method(row, method);
  row.material = "linear_elastic";
  row.dx = cloud.dx;
  row.threads = threads;
  row.integrator = "relax";
  RunResult result;
  try {
    result = simulation.relax({.tolerance = 1e-6});
  } catch (const InputError& error) {  // operators that do not take this cloud
    row.status = "skipped";
    outcome.why = error.what();
    return outcome;
  }
  set_run(row, simulation, result);
  if (result.status != Status::ok) return outcome;
  double peak = 0, difference = 0, size = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    // The rim only holds the plate: it is told what to do.
    if (rim(cloud.X[i])) continue;
    const Mat<2> sigma = simulation.first_piola_kirchhoff(i), truth = exact.stress(cloud.X[i]);
    const Mat<2> symmetric = (sigma + sigma.transpose()) / 2;
    peak = std::max(peak, symmetric_eigen<2>(symmetric).values[1]);
    difference += cloud.V[i] * (sigma - truth).squaredNorm();
    size += cloud.V[i] * truth.squaredNorm();
  }
  outcome.peak = peak / exact.S;
  outcome.stress_error = std::sqrt(difference / size);
  return outcome;
}

}  // namespace

Section study_sheet(const StudyOptions& options) {
  Section section;
  section.title = "Sheet with a hole: stress concentration";
  section.text.push_back(
      fmt::format("A quarter of a plate in plane stress (E = 70 MPa, ν = 0.49) around a hole of radius {:g} "
                  "mm, out to {:g} mm, where the exact "
                  "displacement of an infinite plate under tension (Kirsch) is prescribed; linear elastic, "
                  "total Lagrangian. The largest principal "
                  "stress over the tension far away is 3 exactly. The lattice has its hole in steps; the "
                  "fitted cloud has its points on circles.",
                  hole * 1e3, outside * 1e3));
  std::vector<double> spacings = {hole / 4, hole / 8};
  if (!options.common.quick) spacings.insert(spacings.end(), {hole / 16, hole / 32});

  Refinement peak{"peak_stress", spacings, {}, {}}, stress{"stress", spacings, {}, {}};
  std::vector<double> per_radius;
  TextTable factors{
      "Sheet with a hole: largest principal stress over the tension far away (exact: 3)", "", {"method"}, {}};
  for (const double dx : spacings) {
    per_radius.push_back(hole / dx);
    peak.names.push_back(fmt::format("a/{:g}", hole / dx));
    factors.header.push_back("dx = " + peak.names.back());
  }
  stress.names = peak.names;
  std::vector<Method> methods;
  for (const std::string& operators : names().operators)
    for (const double support_dx : {1.5, 2.4})
      methods.push_back(with_defaults({.operators = operators, .support_dx = support_dx}));
  methods.push_back({.formulation = "tl_stress_points"});
  ProgressLine progress(options.common.quiet, 2 * methods.size());
  std::size_t item = 0;
  for (const bool fitted : {false, true})
    for (const Method& method : methods) {
      const std::string label =
          (fitted ? "fitted, " : "lattice, ") +
          (has_pairs(method.formulation) ? fmt::format("{}, {:g} dx", method.operators, method.support_dx)
                                         : method.formulation);
      progress.begin(item++, "sheet with a hole, " + label);
      RefinementLine peaks{label, {}, {}}, errors{label, {}, {}};
      std::vector<HtmlCell> cells = {{label, ""}};
      std::string outcome;
      for (const double dx : spacings) {
        Outcome one = run_sheet(method, fitted, dx, options.common.threads);
        cells.push_back({one.peak ? fmt::format("{:.3f}", *one.peak) : one.row.status, "number"});
        outcome += cells.back().text + ' ';
        if (!one.why.empty()) outcome += "(" + one.why + ") ";
        peaks.error.push_back(one.peak ? std::optional(std::abs(*one.peak / 3 - 1)) : std::nullopt);
        errors.error.push_back(one.stress_error);
        Row row = one.row;
        row.quantity = "peak_stress_factor";
        if (one.peak)
          row.value = *one.peak, row.reference = 3, row.error = error_of(*one.peak, 3, false), row.unit = "1";
        section.rows.push_back(row);
        row.quantity = "stress_error";
        row.reference.reset();
        if (one.stress_error) row.value = row.error = one.stress_error;
        section.rows.push_back(row);
        peaks.row = shared_columns(row);
      }
      errors.row = peaks.row;
      progress.end("stress factors " + outcome);
      factors.rows.push_back(std::move(cells));
      peak.lines.push_back(std::move(peaks));
      stress.lines.push_back(std::move(errors));
    }
  section.tables.push_back(std::move(factors));
  section.tables.push_back(order_table(stress, "Sheet with a hole: relative L2 error of the stress", ""));
  for (const Refinement* r : {&peak, &stress})
    for (Row& row : order_rows(*r)) section.rows.push_back(std::move(row));
  for (const bool fitted : {false, true}) {
    Refinement part = stress;
    std::erase_if(part.lines,
                  [&](const RefinementLine& l) { return l.label.starts_with("fitted") != fitted; });
    section.charts.push_back(error_chart(
        part, per_radius,
        {fmt::format("sheet_with_hole_stress_{}", fitted ? "fitted" : "lattice"),
         fmt::format("Sheet with a hole, {}: error of the stress", fitted ? "fitted cloud" : "lattice"),
         "Relative L2 error. Dashed: first and second order.",
         "hole radius / dx",
         "error [%]",
         true,
         true,
         false,
         {}}));
  }
  return section;
}

}  // namespace taut::bench
