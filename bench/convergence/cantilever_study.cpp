#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <convergence/refinement.hpp>
#include <convergence/run_row.hpp>
#include <lib/case.hpp>
#include <lib/names.hpp>
#include <lib/progress.hpp>
#include <lib/scene_loader.hpp>
#include <taut/base/error.hpp>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {
namespace {

constexpr double jitter = 0.15;

/// A run of the scene, at its sweep's spacing `dx`.
struct Job {
  Method method = with_defaults({});
  bool jittered = false;
  double dx = 0;
};

std::string label_of(const Job& job) {
  const Method& m = job.method;
  const std::string formulation = m.formulation == with_defaults({}).formulation ? "" : ", " + m.formulation;
  return (job.jittered ? "jittered" : "lattice") +
         (has_pairs(m.formulation) ? fmt::format(", {}, {}, {:g} dx", m.operators, m.kernel, m.support_dx)
                                   : "") +
         formulation;
}

class CantileverStudy {
 public:
  explicit CantileverStudy(const StudyOptions& options)
      : options_(options),
        scene_(load_scene(options.scenes / "cantilever_convergence.toml", options.common.quick)) {
    seeds_ = options.common.quick ? 2 : 5;
    controls_ = options.common.quick ? std::vector<double>{0, 0.1} : std::vector<double>{0, 0.1, 1, 10};
    for (const auto& [name, values] : scene_.sweep)
      if (name == "dx") spacings_ = values;
    if (spacings_.size() < 2)
      throw InputError(scene_.file + ": [sweep] dx: the convergence study needs two spacings or more");
    // The standard operators see a constant displacement gradient wrongly at every face, however fine: no
    // order to look for. With a constant slope out to the support's edge `quadratic` weighs diagonal
    // neighbours more than smoother kernels do.
    Method method = scene_.runs.at(0).method;
    const std::string kernel = method.kernel;
    const double support_dx = method.support_dx;
    for (const std::string& operators : names().operators) {
      if (exactness(operators) < 1) continue;
      // With their wide support they take as long as all others together.
      if (exactness(operators) > 1 && options.common.quick) continue;
      method.operators = operators;
      method.kernel = kernel;
      // A quadratic takes more neighbours than 1.5 dx reaches.
      method.support_dx = std::max(support_dx, default_support(method.formulation, operators));
      variants_.push_back({method});
      method.kernel = "quadratic";
      if (operators != with_defaults({}).operators && kernel != method.kernel) variants_.push_back({method});
    }
    variants_.push_back({{.formulation = "tl_stress_points"}});
  }

  Section run() {
    section_.title = "Cantilever at −250 N: tip error under refinement";
    section_.text.push_back(
        fmt::format("The beam of bench/scenes/cantilever_convergence.toml (bending by a quarter of its "
                    "length, St. Venant–Kirchhoff), total Lagrangian. Error: size of the relative error of "
                    "the tip's deflection "
                    "against quadratic finite elements. Jittered: inner points "
                    "moved by up to {:g} spacings; mean over {} seeds of the sizes of their errors.",
                    jitter, seeds_));
    const std::size_t clouds = 2;
    std::size_t runs_a_cloud = 0;
    for (const Job& job : variants_)
      runs_a_cloud += spacings_.size() + has_pairs(job.method.formulation) + controls_.size() -
                      static_cast<std::size_t>(std::count(controls_.begin(), controls_.end(),
                                                          default_control(job.method.formulation)));
    ProgressLine progress(options_.common.quiet, clouds * runs_a_cloud);
    progress_ = &progress;
    refine();
    vary_control();
    return std::move(section_);
  }

 private:
  /// Mean size of the tip's error over the seeds; nothing when one broke.
  std::optional<double> error(const Job& job) {
    const double control = job.method.zero_energy_control.value_or(default_control(job.method.formulation));
    progress_->begin(item_++, fmt::format("cantilever, {}, dx {:g} mm, control {:g}", label_of(job),
                                          job.dx * 1e3, control));
    std::vector<std::optional<double>> errors;
    double signed_mean = 0;
    for (unsigned seed = 1; seed <= (job.jittered ? static_cast<unsigned>(seeds_) : 1u); ++seed) {
      RunSpec spec = scene_.runs.at(0);
      spec.label = label_of(job);
      spec.method = job.method;
      spec.lattice.jitter = job.jittered ? jitter : 0;
      spec.lattice.seed = seed;
      spec.only.clear();
      // Some four times what equilibria here take: control that feeds a motion is given up as broken.
      spec.solve.max_steps = static_cast<std::int64_t>(1000 * scene_.geometry.max.at(0) / job.dx);
      SweepPoint point = scene_.points().front();
      point["dx"] = job.dx;
      CaseOptions how;
      how.progress = [&](std::int64_t steps, double, double fraction) {
        progress_->update(steps, fraction);
        return true;
      };
      CaseResult result;
      try {
        result = run_case(scene_, spec, point, how);
      } catch (const InputError& error) {  // operators that do not take this body
        Row row = shared_row(job);
        row.quantity = "tip_uy";
        row.dx = job.dx;
        row.status = "skipped";
        section_.rows.push_back(std::move(row));
        progress_->end(std::string("skipped: ") + error.what());
        return {};
      }
      for (Row row : result.rows(options_.common.threads)) {
        row.scene = job.jittered ? "cantilever_jittered" : "cantilever_lattice";
        if (job.method.zero_energy_control) row.quantity += "_control_" + snake_number(control);
        if (job.jittered) row.quantity += fmt::format("_seed_{}", seed);
        section_.rows.push_back(std::move(row));
      }
      const Measured& tip = result.measured.at(0);
      if (tip.value && tip.reference) {
        const double e = error_of(*tip.value, *tip.reference, false);
        signed_mean += e / (job.jittered ? seeds_ : 1);
        errors.push_back(std::abs(e));
      } else {
        errors.push_back({});
      }
    }
    const auto mean = mean_of(errors);
    progress_->end(
        mean ? fmt::format("tip error {:.3g} % (mean with sign {:+.3g} %)", 100 * *mean, 100 * signed_mean)
             : "broke");
    return mean;
  }

  Row shared_row(const Job& job) const {
    Row row;
    row.scene = job.jittered ? "cantilever_jittered" : "cantilever_lattice";
    set_method(row, job.method);
    row.material = scene_.material.model;
    row.threads = options_.common.threads;
    row.integrator = std::string("relax");
    return row;
  }

  void refine() {
    Refinement r{"tip_uy", spacings_, {}, {}};
    std::vector<double> per_mm;
    for (const double dx : spacings_) {
      r.names.push_back(fmt::format("{:g} mm", dx * 1e3));
      per_mm.push_back(1e-3 / dx);
    }
    for (const bool jittered : {false, true})
      for (Job job : variants_) {
        job.jittered = jittered;
        RefinementLine line{label_of(job), shared_row(job), {}};
        for (const double dx : spacings_) {
          job.dx = dx;
          line.error.push_back(error(job));
          if (jittered && line.error.back()) {
            Row row = line.row;
            row.dx = dx;
            row.quantity = "tip_uy_mean_error";
            row.value = row.error = line.error.back();
            row.unit = "1";
            section_.rows.push_back(std::move(row));
          }
        }
        r.lines.push_back(std::move(line));
      }
    section_.tables.push_back(order_table(r, "Cantilever: error of the tip's deflection", ""));
    for (Row& row : order_rows(r)) section_.rows.push_back(std::move(row));
    section_.charts.push_back(error_chart(r, per_mm,
                                          {"cantilever_tip",
                                           "Cantilever at −250 N: error of the tip's deflection",
                                           "Jittered: mean over the seeds. Dashed: first and second order.",
                                           "1/dx [1/mm]",
                                           "|error| [%]",
                                           true,
                                           true,
                                           false,
                                           {}}));
    refined_ = std::move(r);
  }

  /// The answer should not depend on a coefficient that the user picks.
  void vary_control() {
    const std::size_t level = 1;
    TextTable table{
        fmt::format("Cantilever, dx {:g} mm: error under zero-energy control", spacings_[level] * 1e3),
        "spread: largest less smallest error over the coefficients, of those that came to rest, in points of "
        "per cent; broke: no equilibrium; bonds: tl_bond_associated, which has no coefficient.",
        {"method"},
        {}};
    Chart chart{"cantilever_control",
                table.title,
                "Error of the tip's deflection against the coefficient of the control. Marks at "
                "0.01: without control.",
                "coefficient of the zero-energy control",
                "|error| [%]",
                true,
                true,
                false,
                {}};
    for (const double c : controls_) table.header.push_back(c == 0 ? "off" : fmt::format("{:g}", c));
    table.header.push_back("spread");
    table.header.push_back("bonds");
    std::size_t line = 0;
    for (const bool jittered : {false, true})
      for (Job job : variants_) {
        job.jittered = jittered;
        job.dx = spacings_[level];
        const std::string label = label_of(job);
        std::vector<HtmlCell> cells = {{label, ""}};
        Series series{label, Series::Style::run, colour_of(label), {}, {}, {}, true};
        double least = 1e300, most = 0;
        for (const double c : controls_) {
          job.method.zero_energy_control = c;
          const auto e =
              c == default_control(job.method.formulation) ? refined_.lines[line].error[level] : error(job);
          cells.push_back({e ? fmt::format("{:.3g} %", 100 * *e) : "broke", "number"});
          if (!e) continue;
          series.x.push_back(c == 0 ? 0.01 : c), series.y.push_back(100 * *e);
          least = std::min(least, *e), most = std::max(most, *e);
        }
        cells.push_back({most >= least ? fmt::format("{:.3g}", 100 * (most - least)) : "–", "number"});
        if (has_pairs(job.method.formulation)) {
          job.method.zero_energy_control.reset();
          job.method.formulation = "tl_bond_associated";
          const auto bonds = error(job);
          cells.push_back({bonds ? fmt::format("{:.3g} %", 100 * *bonds) : "broke", "number"});
        } else {
          cells.push_back({"–", "number"});
        }
        table.rows.push_back(std::move(cells));
        chart.series.push_back(std::move(series));
        ++line;
      }
    section_.tables.push_back(std::move(table));
    section_.charts.push_back(std::move(chart));
  }

  const StudyOptions& options_;
  Scene scene_;
  int seeds_ = 1;
  std::vector<double> spacings_, controls_;
  std::vector<Job> variants_;  ///< what both clouds are tried with
  ProgressLine* progress_ = nullptr;
  std::size_t item_ = 0;
  Refinement refined_;
  Section section_;
};

}  // namespace

Section study_cantilever(const StudyOptions& options) { return CantileverStudy(options).run(); }

}  // namespace taut::bench
