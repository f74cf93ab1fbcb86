#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <convergence/cube_run.hpp>
#include <convergence/method_label.hpp>
#include <convergence/refinement.hpp>
#include <lib/names.hpp>
#include <lib/progress.hpp>
#include <set>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {
namespace {

constexpr double jitter = 0.15;

std::vector<Method> methods() {
  std::vector<Method> all;
  for (const std::string& formulation : names().formulations) {
    if (!has_pairs(formulation)) {
      for (const std::optional<double> control :
           {std::optional<double>(), std::optional(0.0), std::optional(3.0)})
        all.push_back({.formulation = formulation, .zero_energy_control = control});
      continue;
    }
    // Updated Lagrangian forms have no operators but a choice of velocity gradient, of two of the names.
    const std::vector<std::string> gradients = {"standard", "corrected"};
    for (const std::string& operators : is_updated(formulation) ? gradients : names().operators) {
      for (const double support_dx : {1.5, 2.4}) {
        Method m = with_defaults({});
        m.formulation = formulation;
        m.operators = operators;
        m.support_dx = support_dx;
        if (is_updated(formulation)) m.velocity_gradient = operators;
        all.push_back(m);
        if (!has_parameter(formulation, "zero_energy_control") || exactness(operators) < 1) continue;
        for (const double control : {1.0, 10.0}) {
          m.zero_energy_control = control;
          all.push_back(m);
        }
      }
    }
  }
  return all;
}

/// The cloud, and where runs start.
struct Variant {
  bool jittered = false, undeformed = false;
  const char* cloud() const { return jittered ? "jittered" : "lattice"; }
  std::string name() const { return std::string(cloud()) + (undeformed ? ", undeformed start" : ""); }
};

constexpr Variant variants[] = {{false, false}, {true, false}, {false, true}, {true, true}};

/// Whether runs from the undeformed state tell anything new of a method: rate forms start there anyway. Wide
/// supports and controlled methods are left out, for these runs are twice as long.
bool takes(const Variant& variant, const Method& m) {
  return !variant.undeformed || (!is_updated(m.formulation) && !m.zero_energy_control && m.support_dx < 2);
}

class CubeStudy {
 public:
  explicit CubeStudy(const StudyOptions& options)
      : options_(options),
        levels_(options.common.quick ? std::vector<int>{8, 16} : std::vector<int>{8, 16, 32}),
        seeds_(options.common.quick ? 2 : 3),
        methods_(methods()),
        progress_(options.common.quiet, items()) {}

  Section run() {
    section_.title = "Swinging cube: order of every method";
    section_.text.push_back(fmt::format(
        "A linear elastic unit cube in its exact standing wave (E = 17 MPa, ν = 0.3, ρ = 1100 kg/m³, "
        "amplitude 0.5 mm). Errors: "
        "relative L2 norms over all particles weighted with their volumes, of the velocity and of the stress "
        "component P_xX, at t = 2 ms as in the "
        "sources and over the first quarter period (4 ms, sixteen instants): at one time alone the error "
        "rises and falls with the spacing, for "
        "waves from the faces meet it at one phase or another. "
        "Recovered stress: that of a quadratic fit of the stresses around each particle (StressRecovery), of "
        "finite elements those of the "
        "elements. At t = 0 the cube is given its exact displacement, as in the sources; with an undeformed "
        "start it swings there from the undeformed "
        "state at full speed, a quarter period early, so that the faces need not ring. "
        "Lattice: node-centred. Jittered: inner points moved by up to {:g} spacings along each axis; mean of "
        "{} seeds. Black: trilinear finite "
        "elements with lumped mass and eight Gauss points on the same nodes, with the same time step. "
        "Methods "
        "without a formulation before them: tl_displacement.",
        jitter, seeds_));
    for (const Variant& variant : variants) study(variant);
    if (!skipped_.empty()) {
      std::string text = "Skipped, for they cannot take the cube:";
      for (const std::string& why : skipped_) text += "\n" + why;
      section_.text.push_back(text);
    }
    return std::move(section_);
  }

 private:
  /// The errors that a run has.
  enum Kind {
    velocity_quarter,
    stress_quarter,
    recovered_quarter,
    velocity_snapshot,
    stress_snapshot,
    recovered_snapshot,
    kinds
  };
  static constexpr const char* quantities[kinds] = {"velocity_quarter_period",
                                                    "stress_quarter_period",
                                                    "recovered_stress_quarter_period",
                                                    "velocity",
                                                    "stress",
                                                    "recovered_stress"};
  static constexpr const char* rows[kinds] = {"velocity_error_quarter_period",
                                              "stress_error_quarter_period",
                                              "recovered_stress_error_quarter_period",
                                              "velocity_error",
                                              "stress_error",
                                              "recovered_stress_error"};
  static constexpr const char* words[kinds] = {"velocity over a quarter period",
                                               "stress over a quarter period",
                                               "recovered stress over a quarter period",
                                               "velocity at 2 ms",
                                               "stress at 2 ms",
                                               "recovered stress at 2 ms"};
  using Lines = std::array<RefinementLine, kinds>;

  static std::array<std::optional<double>, kinds> errors_of(const CubeRun& run) {
    if (!run.snapshot) return {};
    return {run.quarter->velocity,  run.quarter->stress,  run.quarter->recovered,
            run.snapshot->velocity, run.snapshot->stress, run.snapshot->recovered};
  }

  std::size_t items() const {
    std::size_t count = std::size(variants);  // finite elements
    for (const Variant& variant : variants)
      count += static_cast<std::size_t>(std::count_if(methods_.begin(), methods_.end(),
                                                      [&](const Method& m) { return takes(variant, m); }));
    return count;
  }

  /// All spacings of one method, means over the seeds. `run(spec)` makes one run.
  template <class F>
  Lines refine(const Method& method, const std::string& label, const Variant& variant, F&& run) {
    progress_.begin(item_++, fmt::format("swinging cube, {}, {}", variant.name(), label));
    const bool jittered = variant.jittered;
    const std::string suffix = (variant.undeformed ? "_undeformed_start" : "") + suffix_of(method);
    Lines lines;
    std::string outcome;
    for (const int intervals : levels_) {
      std::array<std::vector<std::optional<double>>, kinds> errors;
      Row last;
      for (unsigned seed = 1; seed <= (jittered ? static_cast<unsigned>(seeds_) : 1u); ++seed) {
        // Fits take longer than the coarse runs of the quick form.
        const bool recover = !options_.common.quick || !method.zero_energy_control;
        const CubeRun one =
            run(CubeSpec{method, intervals, jittered ? jitter : 0, seed, variant.undeformed, recover});
        last = one.row;
        const auto found = errors_of(one);
        for (std::size_t k = 0; k < kinds; ++k) {
          errors[k].push_back(found[k]);
          add(one.row, rows[k] + suffix + (jittered ? fmt::format("_seed_{}", seed) : ""), found[k]);
        }
        if (one.row.status == "skipped") {
          skipped_.insert(label + ": " + one.why);
          break;
        }
        if (one.row.status == "broke") outcome += fmt::format(" 1/h = {}: broke ({}).", intervals, one.why);
      }
      for (std::size_t k = 0; k < kinds; ++k) {
        lines[k].error.push_back(mean_of(errors[k]));
        lines[k].row = shared_columns(last);
        lines[k].label = label;
        lines[k].suffix = suffix;
        if (jittered && lines[k].error.back()) {
          Row row = shared_columns(last);
          row.dx = last.dx;
          row.unit = last.unit;
          add(row, rows[k] + suffix + "_mean", lines[k].error.back());
        }
      }
      if (const auto v = lines[velocity_quarter].error.back())
        outcome += fmt::format(" 1/h = {}: velocity {:.3g} %, stress {:.3g} %.", intervals, 100 * *v,
                               100 * *lines[stress_quarter].error.back());
    }
    progress_.end(outcome.empty() ? "skipped" : outcome.substr(1));
    return lines;
  }

  void add(Row row, const std::string& quantity, std::optional<double> error) {
    if (row.status == "ok" && !error) return;  // stresses that nothing recovers
    row.quantity = quantity;
    if (row.status == "ok") row.value = row.error = error;
    section_.rows.push_back(std::move(row));
  }

  void study(const Variant& variant) {
    std::array<Refinement, kinds> all;
    std::vector<double> per_h(levels_.begin(), levels_.end());
    for (std::size_t k = 0; k < kinds; ++k) {
      all[k].quantity = quantities[k];
      for (const int n : levels_) {
        all[k].h.push_back(1.0 / n);
        all[k].names.push_back(fmt::format("1/{}", n));
      }
    }
    const auto add_lines = [&](Lines lines) {
      if (!lines[0].error.front()) return;  // skipped, or broke from the start: said elsewhere
      for (std::size_t k = 0; k < kinds; ++k)
        if (lines[k].error.front()) all[k].lines.push_back(std::move(lines[k]));
    };
    add_lines(refine({}, "finite elements", variant,
                     [&](const CubeSpec& spec) { return run_cube_fem(spec, options_.common.threads); }));
    for (Refinement& r : all) r.lines.back().yardstick = true;
    for (const Method& m : methods_)
      if (takes(variant, m))
        add_lines(refine(m, label_of(m), variant,
                         [&](const CubeSpec& spec) { return run_cube(spec, options_.common.threads); }));
    for (std::size_t k = 0; k < kinds; ++k)
      report(all[k], words[k], k <= recovered_quarter && !variant.undeformed, per_h, variant);
  }

  void report(const Refinement& all, const std::string& what, bool draw, const std::vector<double>& per_h,
              const Variant& variant) {
    const std::string cloud = variant.cloud();
    section_.tables.push_back(
        order_table(all, fmt::format("Swinging cube, {}: error of {}", variant.name(), what), ""));
    TextTable& table = section_.tables.back();
    table.header.push_back("over FEM");
    for (std::size_t i = 0; i < all.lines.size(); ++i) {
      const auto ours = all.lines[i].error.back(), fem = all.lines[0].error.back();
      table.rows[i].push_back({ours && fem ? fmt::format("{:.2f}", *ours / *fem) : "–", "number"});
    }
    table.note = fmt::format("over FEM: error over that of the finite elements at {}.", all.names.back());
    for (Row& row : order_rows(all)) section_.rows.push_back(std::move(row));
    if (!draw) return;
    for (const bool rates : {false, true}) {
      Refinement part = all;
      std::erase_if(part.lines, [&](const RefinementLine& l) {
        return !l.yardstick && is_updated(l.row.formulation) != rates;
      });
      if (part.lines.size() < 2) continue;
      const char* family = rates ? "updated" : "total";
      section_.charts.push_back(
          error_chart(part, per_h,
                      {fmt::format("swinging_cube_{}_{}_{}", all.quantity, cloud, family),
                       fmt::format("Swinging cube, {}, {} Lagrangian: {}", cloud, family, what),
                       "Relative L2 error over particles and times. Dashed: first and second order.",
                       "1/h",
                       "error [%]",
                       true,
                       true,
                       false,
                       {}}));
    }
  }

  const StudyOptions& options_;
  std::vector<int> levels_;
  int seeds_;
  std::vector<Method> methods_;
  ProgressLine progress_;
  std::size_t item_ = 0;
  Section section_;
  std::set<std::string> skipped_;
};

}  // namespace

Section study_cube(const StudyOptions& options) { return CubeStudy(options).run(); }

}  // namespace taut::bench
