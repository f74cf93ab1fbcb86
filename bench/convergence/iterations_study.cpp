#include <fmt/format.h>

#include <cmath>
#include <convergence/cube_run.hpp>
#include <convergence/run_row.hpp>
#include <convergence/study.hpp>
#include <lib/case.hpp>
#include <lib/progress.hpp>
#include <lib/scene_loader.hpp>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {
namespace {

constexpr double jitter = 0.15;

}  // namespace

Section study_iterations(const StudyOptions& options) {
  const bool quick = options.common.quick;
  const int intervals = quick ? 8 : 16;
  const std::vector<int> counts =
      quick ? std::vector<int>{1, 5, 20, 80} : std::vector<int>{1, 2, 5, 10, 20, 40, 80, 160, 320};
  const double beam_dx = quick ? 2e-3 : 1e-3;
  Scene scene = load_scene(options.scenes / "cantilever_convergence.toml", quick);

  Section section;
  section.title = "How long to iterate in the set-up of compatible operators";
  section.text.push_back(
      fmt::format("Final errors against conjugate-gradient iterations, jittered clouds (seed 1): "
                  "acceleration of the swinging cube at t = 0 with {} intervals, and the "
                  "tip of the cantilever at dx {:g} mm, −250 N. The default is {} iterations.",
                  intervals, beam_dx * 1e3, Method().compatible_iterations));
  TextTable table{"Error against iterations of the compatible set-up", "", {"iterations"}, {}};
  Chart chart{"compatible_iterations",
              table.title,
              "Jittered clouds. The curves flatten where other errors lead.",
              "conjugate-gradient iterations",
              "|error| [%]",
              true,
              true,
              false,
              {}};
  for (const int n : counts) chart.x_ticks.push_back(n);
  for (const double support_dx : {1.5, 2.4}) {
    for (const char* what : {"cube, acceleration", "cantilever, tip"}) {
      chart.series.push_back({fmt::format("{}, {:g} dx", what, support_dx),
                              Series::Style::run,
                              static_cast<int>(chart.series.size()),
                              {},
                              {},
                              {},
                              true});
      table.header.push_back(chart.series.back().label);
    }
  }

  ProgressLine progress(options.common.quiet, counts.size());
  for (std::size_t k = 0; k < counts.size(); ++k) {
    progress.begin(k, fmt::format("{} iterations", counts[k]));
    std::vector<HtmlCell> cells = {{fmt::format("{}", counts[k]), "number"}};
    std::size_t column = 0;
    const auto add = [&](Row row, const std::string& quantity, std::optional<double> error) {
      cells.push_back({error ? fmt::format("{:.3g} %", 100 * *error) : "broke", "number"});
      Series& series = chart.series[column++];
      if (error) series.x.push_back(counts[k]), series.y.push_back(100 * *error);
      row.quantity = fmt::format("{}_iterations_{}", quantity, counts[k]);
      section.rows.push_back(std::move(row));
    };
    for (const double support_dx : {1.5, 2.4}) {
      Method method = with_defaults({});
      method.operators = "compatible";
      method.support_dx = support_dx;
      method.compatible_iterations = counts[k];
      const auto acceleration = initial_acceleration_error({method, intervals, jitter, 1});
      Row row;
      row.scene = "swinging_cube_jittered";
      set_method(row, method);
      row.material = "linear_elastic";
      row.dx = 1.0 / intervals;
      row.threads = options.common.threads;
      row.unit = "1";
      row.value = row.error = acceleration;
      if (!acceleration) row.status = "broke";
      add(row, "initial_acceleration_error", acceleration);

      RunSpec spec = scene.runs.at(0);
      spec.method = method;
      spec.lattice.jitter = jitter;
      spec.only.clear();
      SweepPoint point = scene.points().front();
      point["dx"] = beam_dx;
      const CaseResult result = run_case(scene, spec, point, {});
      Row tip = result.rows(options.common.threads).at(0);
      tip.scene = "cantilever_jittered";
      add(tip, tip.quantity,
          tip.status != "broke" && tip.error ? std::optional(std::abs(*tip.error)) : std::nullopt);
    }
    progress.end(fmt::format("cube {}, cantilever {} (support 1.5 dx)", cells[1].text, cells[2].text));
    table.rows.push_back(std::move(cells));
  }
  section.tables.push_back(std::move(table));
  section.charts.push_back(std::move(chart));
  return section;
}

}  // namespace taut::bench
