#include <fmt/format.h>

#include <algorithm>
#include <lib/names.hpp>
#include <map>
#include <scaling/row_query.hpp>
#include <scaling/summary.hpp>

namespace taut::bench {
namespace {

constexpr double million = 1e-6;

/// The same colour in every chart.
int colour_of(const Row& row) {
  if (row.formulation == "baseline_csr") return 6;
  if (row.formulation == "baseline_eigen") return 7;
  if (is_updated(row.formulation)) return 5;
  if (row.scene.starts_with("jittered")) return 4;
  return row.precision == "shared" ? 0 : row.precision == "single" ? 1 : row.precision == "double" ? 2 : 3;
}

/// Jittered clouds stand in charts with the payload that suits them.
bool charted(const Row& row) {
  return is_step(row) &&
         (is_updated(row.formulation) || row.scene.starts_with("lattice") || row.precision == "single");
}

/// Which points of which rows a line joins: those with the same label, in the order of x.
template <class Label, class X, class Y, class Colour = int (*)(const Row&)>
std::vector<Series> lines(const std::vector<Row>& rows, Label&& label, X&& x, Y&& y,
                          Colour&& colour = colour_of) {
  std::vector<Series> series;
  std::map<std::string, std::map<double, double>> points;
  std::vector<std::string> order;
  std::map<std::string, int> colours;
  for (const Row& row : rows) {
    const std::string name = label(row);
    if (!points.contains(name)) order.push_back(name);
    colours.try_emplace(name, colour(row));
    points[name].try_emplace(x(row), y(row));
  }
  for (const std::string& name : order) {
    Series s;
    s.label = name;
    s.colour = colours[name];
    for (const auto& [at, value] : points[name]) {
      s.x.push_back(at);
      s.y.push_back(value);
    }
    series.push_back(std::move(s));
  }
  return series;
}

double rate_of(const Row& row) { return *row.value * million; }
double particles_of(const Row& row) { return static_cast<double>(*row.particles); }

int fewest_neighbours(const std::vector<Row>& rows) {
  int fewest = 0;
  for (const Row& row : rows)
    if (dimension_of(row) == 3 && is_step(row) && row.quantity == "rate")
      fewest = fewest == 0 ? neighbours_of(row) : std::min(fewest, neighbours_of(row));
  return fewest;
}

Chart rate_against_particles(const std::vector<Row>& rows) {
  const std::int64_t threads = most_threads(rows);
  const int fewest = fewest_neighbours(rows);
  const auto chosen = cases_of(rows, "rate", [&](const Row& r) {
    const bool usual = is_updated(r.formulation) ||
                       (r.scene.starts_with("lattice") ? r.precision == "shared" : r.precision == "single");
    return dimension_of(r) == 3 && is_step(r) && r.threads == threads && neighbours_of(r) == fewest && usual;
  });
  Chart chart{"rate_particles", fmt::format("Steps of {} neighbours in 3D, {} threads", fewest, threads),
              "Small bodies live in the caches, large ones in memory.", "particles",
              "million particle-steps/s"};
  chart.log_x = chart.log_y = true;
  chart.series = lines(chosen, case_label, particles_of, rate_of);
  return chart;
}

Chart rate_against_threads(const std::vector<Row>& rows) {
  const std::int64_t size = main_size(rows);
  const int fewest = fewest_neighbours(rows);
  const auto chosen = cases_of(rows, "rate", [&](const Row& r) {
    return dimension_of(r) == 3 && r.particles == size && neighbours_of(r) == fewest && !is_dense_case(r) &&
           (!is_step(r) || (charted(r) && r.precision != "double" && r.precision != "recomputed") ||
            is_updated(r.formulation));
  });
  Chart chart{"rate_threads", fmt::format("Steps of {} particles, {} neighbours, 3D", size, fewest), "",
              "threads", "million particle-steps/s"};
  chart.log_x = chart.log_y = true;
  chart.series = lines(
      chosen, case_label, [](const Row& r) { return static_cast<double>(*r.threads); }, rate_of);
  for (int t = 1; t <= most_threads(rows); t *= 2) chart.x_ticks.push_back(t);
  return most_threads(rows) > 1 && std::any_of(chart.series.begin(), chart.series.end(),
                                               [](const Series& s) { return s.x.size() > 1; })
             ? chart
             : Chart{};
}

Chart rate_against_neighbours(const std::vector<Row>& rows) {
  const std::int64_t threads = most_threads(rows), size = main_size(rows);
  const auto chosen = cases_of(rows, "rate", [&](const Row& r) {
    return dimension_of(r) == 3 && r.particles == size && r.threads == threads && !is_dense_case(r) &&
           !r.scene.starts_with("jittered");
  });
  Chart chart{"rate_neighbours",
              fmt::format("Steps of {} particles on a 3D lattice, {} threads", size, threads),
              "By the way pair vectors are kept, and other ways to write the same step.", "neighbours",
              "million particle-steps/s"};
  chart.log_x = chart.log_y = true;
  chart.x_ticks = {18, 32, 56, 80};
  chart.series = lines(
      chosen, case_label, [](const Row& r) { return static_cast<double>(neighbours_of(r)); }, rate_of);
  return chart;
}

Chart fraction_of_limit(const std::vector<Row>& rows) {
  const std::int64_t threads = most_threads(rows), size = main_size(rows);
  const auto chosen = cases_of(rows, "fraction_of_limit", [&](const Row& r) {
    return charted(r) && dimension_of(r) == 3 && r.particles == size && r.threads == threads;
  });
  Chart chart{
      "fraction_of_limit",
      fmt::format("Part of the bandwidth's bound that steps reach, {} particles, {} threads", size, threads),
      "Measured rate over the triad's bandwidth by the bytes that a step must stream.", "neighbours",
      "fraction of limit"};
  chart.log_x = chart.line_at_zero = true;
  chart.x_ticks = {18, 32, 56, 80};
  chart.series = lines(
      chosen, case_label, [](const Row& r) { return static_cast<double>(neighbours_of(r)); },
      [](const Row& r) { return *r.value; });
  return chart;
}

Chart dense_chart(const std::vector<Row>& rows) {
  const auto chosen = cases_of(rows, "rate", [](const Row& r) { return is_dense_case(r); });
  Chart chart{"dense", "Steps against dense matrices", "The same operator in double precision.", "particles",
              "million particle-steps/s"};
  chart.log_x = chart.log_y = true;
  chart.series = lines(
      chosen,
      [](const Row& r) {
        return fmt::format("{}, {}D", r.formulation == "baseline_dense" ? "dense matrices" : "taut",
                           dimension_of(r));
      },
      particles_of, rate_of,
      [](const Row& r) { return (r.formulation == "baseline_dense") + 2 * (dimension_of(r) - 2); });
  return chart;
}

Chart lists_chart(const std::vector<Row>& rows) {
  const std::int64_t threads = most_threads(rows);
  const auto chosen = cases_of(rows, "list_seconds", [&](const Row& r) { return r.threads == threads; });
  if (chosen.empty()) return {};
  Chart chart{"lists", fmt::format("Lists of {} points, {} threads", *chosen.front().particles, threads),
              "Lower is better.", "", "milliseconds"};
  std::vector<std::string> scenes;
  for (const Row& row : chosen)
    if (std::find(scenes.begin(), scenes.end(), row.scene) == scenes.end()) scenes.push_back(row.scene);
  for (const std::string& scene : scenes) chart.x_names.push_back(scene.substr(0, scene.find('_')));
  for (const auto& [formulation, label] :
       {std::pair{"list_taut", "taut, cell list"}, {"list_nanoflann", "nanoflann, radiusSearch"}}) {
    Series s;
    s.label = label;
    s.style = Series::Style::bar;
    s.colour = static_cast<int>(chart.series.size());
    for (const Row& row : chosen)
      if (row.formulation == formulation) {
        s.x.push_back(
            static_cast<double>(std::find(scenes.begin(), scenes.end(), row.scene) - scenes.begin()));
        s.y.push_back(*row.value * 1e3);
      }
    chart.series.push_back(std::move(s));
  }
  return chart;
}

}  // namespace

std::vector<Chart> scaling_charts(const std::vector<Row>& rows) {
  std::vector<Chart> charts = {rate_against_particles(rows),
                               rate_against_neighbours(rows),
                               rate_against_threads(rows),
                               fraction_of_limit(rows),
                               roofline(rows),
                               lists_chart(rows),
                               dense_chart(rows)};
  std::erase_if(charts, [](const Chart& c) { return c.empty(); });
  return charts;
}

Chart roofline(const std::vector<Row>& rows) {
  const std::int64_t threads = most_threads(rows), size = main_size(rows);
  Row machine;
  machine.scene = "machine";
  machine.threads = threads;
  const auto triad = value_of(rows, machine, "triad"), peak = value_of(rows, machine, "multiply_add_peak");
  if (!triad || !peak) return {};
  const auto intensity = [&](const Row& r) {
    return *value_of(rows, r, "flops_per_step") / *value_of(rows, r, "bytes_per_step");
  };
  const auto chosen = cases_of(rows, "rate", [&](const Row& r) {
    return charted(r) && dimension_of(r) == 3 && r.particles == size && r.threads == threads &&
           value_of(rows, r, "bytes_per_step");
  });
  if (chosen.empty()) return {};
  Chart chart{"roofline", fmt::format("Roofline of steps, {} particles in 3D, {} threads", size, threads),
              "A mark a number of neighbours, fewest on the left. Flops of the formulas, bytes that a step "
              "must stream; the roof is the "
              "triad's bandwidth and the rate of multiply-adds.",
              "flops a byte", "Gflop/s"};
  chart.log_x = chart.log_y = true;
  chart.series = lines(chosen, case_label, intensity,
                       [&](const Row& r) { return *r.value * *value_of(rows, r, "flops_per_step") * 1e-9; });
  double least = 1e300, most = *peak / *triad;
  for (const Row& row : chosen) {
    least = std::min(least, intensity(row));
    most = std::max(most, intensity(row));
  }
  Series roof;
  roof.label = fmt::format("limit: {:.1f} GB/s, {:.0f} Gflop/s", *triad * 1e-9, *peak * 1e-9);
  roof.style = Series::Style::truth;
  roof.marks = false;
  for (const double at : {least / 1.5, *peak / *triad, most * 1.5}) {
    roof.x.push_back(at);
    roof.y.push_back(std::min(*triad * at, *peak) * 1e-9);
  }
  chart.series.push_back(std::move(roof));
  return chart;
}

}  // namespace taut::bench
