#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <convergence/bent_bar.hpp>
#include <convergence/cube_run.hpp>
#include <convergence/method_label.hpp>
#include <convergence/pareto.hpp>
#include <convergence/run_row.hpp>
#include <convergence/study.hpp>
#include <lib/case.hpp>
#include <lib/names.hpp>
#include <lib/progress.hpp>
#include <lib/scene_loader.hpp>
#include <numeric>
#include <taut/base/error.hpp>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {
namespace {

constexpr double jitter = 0.15;

/// One run of a body: its row with quantity, value and cost. The row's error is the body's.
using BodyRun = std::function<Row(const Method& method, std::size_t level, double jitter)>;

struct Body {
  std::string name, what;
  std::vector<std::string> levels;
  BodyRun run;
};

struct Choice {
  Method method = with_defaults({});
  std::size_t level = 0;
  bool jittered = false;
  std::vector<double> loop_s;  ///< of the repeats
  Row row;
};

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

Body cube_body(bool quick, int threads) {
  const std::vector<int> intervals = quick ? std::vector<int>{4, 8} : std::vector<int>{8, 16, 32};
  Body body{"swinging_cube", "velocity of the swinging cube over a quarter period", {}, {}};
  for (const int n : intervals) body.levels.push_back(fmt::format("1/{}", n));
  body.run = [=](const Method& method, std::size_t level, double amount) {
    const CubeRun run = run_cube({method, intervals[level], amount, 1}, threads);
    Row row = run.row;
    row.quantity = "velocity_error_quarter_period";
    if (run.quarter) row.value = row.error = run.quarter->velocity;
    return row;
  };
  return body;
}

Body bar_body(bool quick, int threads) {
  const std::vector<int> intervals = quick ? std::vector<int>{4} : std::vector<int>{4, 8, 12};
  Body body{"bent_bar", "tip deflection of the bar in pure bending (3D)", {}, {}};
  for (const int n : intervals) body.levels.push_back(fmt::format("1/{}", n));
  body.run = [=](const Method& method, std::size_t level, double amount) {
    Row row = run_bent_bar(method, intervals[level], amount, 1, threads).row;
    row.quantity = "tip_uy";
    return row;
  };
  return body;
}

Body cantilever_body(const StudyOptions& options) {
  const auto scene = std::make_shared<Scene>(
      load_scene(options.scenes / "cantilever_convergence.toml", options.common.quick));
  const std::vector<double> spacings =
      options.common.quick ? std::vector<double>{4e-3} : std::vector<double>{4e-3, 2e-3, 1e-3};
  Body body{"cantilever", "tip deflection of the cantilever at −250 N", {}, {}};
  for (const double dx : spacings) body.levels.push_back(fmt::format("{:g} mm", dx * 1e3));
  body.run = [=, threads = options.common.threads](const Method& method, std::size_t level, double amount) {
    RunSpec spec = scene->runs.at(0);
    spec.method = method;
    spec.lattice.jitter = amount;
    spec.only.clear();
    spec.solve.max_steps = static_cast<std::int64_t>(1000 * scene->geometry.max.at(0) / spacings[level]);
    SweepPoint point = scene->points().front();
    point["dx"] = spacings[level];
    Row row = run_case(*scene, spec, point, {}).rows(threads).at(0);
    row.scene = std::string("cantilever_") + (amount > 0 ? "jittered" : "lattice");
    return row;
  };
  return body;
}

std::vector<Method> methods(bool quick) {
  std::vector<Method> all;
  for (const std::string& operators : names().operators)
    for (const double support_dx : {1.5, 2.4})
      for (const char* kernel : {"wendland_c2", "quadratic"})
        for (const PairPrecision precision :
             {PairPrecision::single_precision, PairPrecision::double_precision}) {
          // Double precision is compared on one kernel: what it costs and gives does not depend on it.
          const bool other_kernel = kernel != with_defaults({}).kernel;
          const bool in_double = precision == PairPrecision::double_precision;
          if ((other_kernel && in_double) || (quick && (other_kernel || in_double))) continue;
          Method m = with_defaults({});
          m.operators = operators;
          m.support_dx = support_dx;
          m.kernel = kernel;
          m.pair_precision = precision;
          all.push_back(m);
          // Nor does what control of zero-energy modes costs and gives depend on kernel or precision.
          if (other_kernel || in_double || exactness(operators) < 1) continue;
          Method bonds = m;
          bonds.formulation = "tl_bond_associated";
          all.push_back(bonds);
          m.zero_energy_control = 1;
          all.push_back(m);
        }
  all.push_back({.formulation = "tl_stress_points"});
  return all;
}

/// Long loops time well at once.
bool worth_repeating(const Choice& c) {
  constexpr double long_s = 0.5;
  return c.row.status != "skipped" && std::accumulate(c.loop_s.begin(), c.loop_s.end(), 0.0) < long_s;
}

/// Size of the error, of suspect runs too: that is what is studied. Nothing for a run that broke or was
/// skipped.
std::optional<double> error_size(const Row& row) {
  if (row.status == "broke" || row.status == "skipped" || !row.error || !std::isfinite(*row.error)) return {};
  return std::abs(*row.error);
}

/// Colours tell operators apart, marks what is done with them.
int colour_of(const Method& m) {
  const std::vector<std::string> operators = names().operators;
  const auto found =
      has_pairs(m.formulation) ? std::find(operators.begin(), operators.end(), m.operators) : operators.end();
  return static_cast<int>(found - operators.begin());
}

const std::vector<std::string>& mark_names() {
  static const std::vector<std::string> all = {"R = 1.5 dx", "R = 2.4 dx", "control 1", "bond-associated"};
  return all;
}
int mark_of(const Method& m) {
  if (!has_pairs(m.formulation)) return 0;
  if (formulation_traits(m.formulation).stress == StressAt::bonds) return 3;
  return m.zero_energy_control ? 2 : m.support_dx > 2;
}

/// Series without points, so that the legend has a row for each colour and each mark.
void add_legend(Chart& chart, const std::vector<const Choice*>& shown) {
  std::vector<std::string> of_colour = names().operators;
  of_colour.emplace_back("stress points");
  const auto used = [&](auto what) {
    return std::any_of(shown.begin(), shown.end(), [&](const Choice* c) { return what(c->method); });
  };
  const auto add = [&](const std::string& label, int colour, int mark) {
    chart.series.push_back({label, Series::Style::scatter, colour, {}, {}, {}, true, mark});
  };
  for (int c = 0; c < static_cast<int>(of_colour.size()); ++c)
    if (used([&](const Method& m) { return colour_of(m) == c; }))
      add(of_colour[static_cast<std::size_t>(c)], c, 0);
  for (int k = 0; k < static_cast<int>(mark_names().size()); ++k)
    if (used([&](const Method& m) { return has_pairs(m.formulation) && mark_of(m) == k; }))
      add(mark_names()[static_cast<std::size_t>(k)], -1, k);
}

void report(const Body& body, bool jittered, const std::vector<Choice>& choices, int repeats,
            Section& section) {
  const char* cloud = jittered ? "jittered" : "lattice";
  const std::string cost_names[] = {"loop time [s]", "steps × pairs"};
  for (int kind = 0; kind < 2; ++kind) {
    Chart chart{
        fmt::format("frontier_{}_{}_{}", body.name, cloud, kind == 0 ? "time" : "work"),
        fmt::format("Error against {}: {}, {}", kind == 0 ? "loop time" : "pair evaluations", body.what,
                    cloud),
        "Each mark is one combination of operators, support radius, zero-energy control, kernel, "
        "spacing and pair precision; the line is the Pareto front, labelled where a method enters it. "
        "Down and left is better.",
        cost_names[kind],
        "|error| [%]",
        true,
        true,
        false,
        {}};
    // First, so that the marks stand on it.
    chart.series.push_back({"Pareto front", Series::Style::truth, 0, {}, {}, {}, false});
    std::vector<double> cost, error;
    std::vector<const Choice*> shown;
    for (const Choice& c : choices) {
      const auto e = error_size(c.row);
      if (c.jittered != jittered || !e || *e == 0) continue;
      cost.push_back(kind == 0 ? median(c.loop_s)
                               : static_cast<double>(*c.row.steps) * static_cast<double>(*c.row.pairs));
      error.push_back(100 * *e);
      shown.push_back(&c);
      const std::string label = label_of(c.method);
      auto series = std::find_if(chart.series.begin(), chart.series.end(),
                                 [&](const Series& s) { return s.label == label; });
      if (series == chart.series.end()) {
        chart.series.push_back(
            {label, Series::Style::scatter, colour_of(c.method), {}, {}, {}, true, mark_of(c.method), false});
        series = chart.series.end() - 1;
      }
      series->x.push_back(cost.back()), series->y.push_back(error.back());
    }
    add_legend(chart, shown);
    TextTable table{
        fmt::format("Pareto front: {}, {}", body.what, cloud),
        fmt::format("Loop time: median of up to {} repeats.", repeats),
        {"operators, support", "kernel", "precision", "dx", "error", "loop time", "steps × pairs"},
        {}};
    std::string on_front;
    for (const std::size_t i : pareto_front(cost, error)) {
      chart.series[0].x.push_back(cost[i]), chart.series[0].y.push_back(error[i]);
      const Choice& c = *shown[i];
      if (label_of(c.method) != on_front) {
        on_front = label_of(c.method);
        chart.labels.push_back({cost[i], error[i], fmt::format("{}, {}", on_front, body.levels[c.level])});
      }
      table.rows.push_back(
          {{label_of(c.method), ""},
           {c.row.kernel, ""},
           {c.row.precision, ""},
           {body.levels[c.level], ""},
           {fmt::format("{:.3g} %", error[i]), "number"},
           {fmt::format("{:.3g} s", median(c.loop_s)), "number"},
           {fmt::format("{:.3g}", static_cast<double>(*c.row.steps) * static_cast<double>(*c.row.pairs)),
            "number"}});
    }
    section.charts.push_back(std::move(chart));
    if (kind == 0) section.tables.push_back(std::move(table));
  }
}

}  // namespace

Section study_frontier(const StudyOptions& options) {
  const bool quick = options.common.quick;
  const int threads = options.common.threads, repeats = quick ? 1 : 3;
  Section section;
  section.title = "Error against cost";
  section.text.push_back(fmt::format(
      "The swinging cube, the cantilever and a bar in pure bending (3D, exact: 3 m by 1 m by 1 "
      "m, a quarter modelled), total Lagrangian, under every "
      "operator, two support radii, two kernels, single and double pair vectors, with and without "
      "zero-energy control (coefficient 1, or bond-associated gradients), at several "
      "spacings. Times are those of the time loops alone, medians "
      "of up to {} repeats that take turns (fewer of long loops); set-up is in results.csv.",
      repeats));
  const std::vector<Body> bodies = {cube_body(quick, threads), cantilever_body(options),
                                    bar_body(quick, threads)};
  const std::vector<Method> all = methods(quick);
  std::size_t items = 0, item = 0;
  for (const Body& body : bodies) items += body.levels.size() * all.size() * 2;
  ProgressLine progress(options.common.quiet, items * static_cast<std::size_t>(repeats));
  for (const Body& body : bodies) {
    std::vector<Choice> choices;
    for (std::size_t level = 0; level < body.levels.size(); ++level)
      for (const bool jittered : {false, true})
        for (const Method& m : all) choices.push_back({m, level, jittered, {}, {}});
    for (int repeat = 0; repeat < repeats; ++repeat)
      for (Choice& c : choices) {
        if (repeat > 0 && !worth_repeating(c)) {
          ++item;
          continue;
        }
        progress.begin(
            item++, fmt::format("{}, {}, {}, {}, {}, dx {}", body.name, c.jittered ? "jittered" : "lattice",
                                label_of(c.method), c.method.kernel, to_string(c.method.pair_precision),
                                body.levels[c.level]));
        try {
          c.row = body.run(c.method, c.level, c.jittered ? jitter : 0);
          c.row.quantity += suffix_of(c.method);
        } catch (const InputError& error) {  // a combination that the library does not take
          set_method(c.row, c.method);
          c.row.scene = body.name + (c.jittered ? "_jittered" : "_lattice");
          c.row.status = std::string("skipped");
          progress.end(std::string("skipped: ") + error.what());
          c.loop_s.push_back(0);
          continue;
        }
        c.loop_s.push_back(c.row.loop_s.value_or(0));
        const auto e = error_size(c.row);
        progress.end(e ? fmt::format("error {:.3g} %, loop {:.3g} s", 100 * *e, c.loop_s.back())
                       : c.row.status);
      }
    for (const Choice& c : choices) {
      Row row = c.row;
      if (row.loop_s) row.loop_s = median(c.loop_s);
      if (row.loop_s && *row.loop_s > 0 && row.particles && row.steps)
        row.particle_steps_per_s =
            static_cast<double>(*row.particles) * static_cast<double>(*row.steps) / *row.loop_s;
      section.rows.push_back(std::move(row));
    }
    for (const bool jittered : {false, true}) report(body, jittered, choices, repeats, section);
  }
  return section;
}

}  // namespace taut::bench
