#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/files.hpp>
#include <lib/reference.hpp>
#include <lib/scene_charts.hpp>
#include <set>

namespace taut::bench {
namespace {

using Cases = std::vector<const CaseResult*>;

/// A unit in which numbers of this size read well.
struct ShownUnit {
  double factor;
  std::string name;
};

ShownUnit shown_unit(const std::string& unit, double size) {
  if (unit == "m") return {1e3, "mm"};
  if (unit == "s" && size < 1e-3) return {1e6, "µs"};
  if (unit == "s" && size < 1) return {1e3, "ms"};
  if (unit == "Pa" && size >= 1e6) return {1e-6, "MPa"};
  if (unit == "Pa" && size >= 1e3) return {1e-3, "kPa"};
  return {1, unit};
}

const Measured* measured(const CaseResult& c, const ProbeSpec& probe) {
  for (const Measured& m : c.measured)
    if (m.probe == &probe) return &m;
  return nullptr;
}

std::optional<double> relative_error(const Measured& m) {
  if (!m.value) return {};
  if (m.probe->measure == "curve_error") return m.value;
  if (!m.reference || *m.reference == 0) return {};
  return *m.value / *m.reference - 1;
}

std::vector<double> swept(const Scene& scene, const std::string& name) {
  for (const auto& [key, values] : scene.sweep)
    if (key == name) return values;
  return {};
}

/// The sweep without some variables: one chart for each point of it.
std::vector<SweepPoint> others(const Scene& scene, const std::vector<std::string>& names) {
  std::vector<SweepPoint> points;
  for (SweepPoint point : scene.points()) {
    for (const std::string& name : names) point.erase(name);
    if (std::find(points.begin(), points.end(), point) == points.end()) points.push_back(point);
  }
  return points;
}

Cases select(const std::vector<CaseResult>& cases, const RunSpec& run, const SweepPoint& part) {
  Cases found;
  for (const CaseResult& c : cases)
    if (c.run == &run &&
        std::all_of(part.begin(), part.end(), [&](const auto& e) { return c.point.at(e.first) == e.second; }))
      found.push_back(&c);
  return found;
}

/// For each load the case of finest spacing.
Cases finest(const Cases& cases) {
  Cases found;
  for (const CaseResult* c : cases) {
    const auto same = std::find_if(found.begin(), found.end(), [&](const CaseResult* f) {
      return f->point.at("load") == c->point.at("load");
    });
    if (same == found.end())
      found.push_back(c);
    else if (c->dx < (*same)->dx)
      *same = c;
  }
  return found;
}

std::string suffix(const SweepPoint& part) { return part.empty() ? "" : " (" + describe(part) + ")"; }

/// Value against load with the truth, and the error against load.
void add_load_charts(const Scene& scene, const std::vector<CaseResult>& cases, const ProbeSpec& probe,
                     const SweepPoint& part, std::vector<Chart>& charts) {
  const ShownUnit unit = shown_unit(probe.unit(), 0);
  const std::string name = file_name_of(scene.name + ' ' + probe.name + ' ' + describe(part));
  Chart value{name,
              probe.name + " against load" + suffix(part),
              "Crosses along the lower edge: the formulation broke at this load.",
              "load [N]",
              fmt::format("{} [{}]", probe.name, unit.name),
              false,
              false,
              true,
              {}};
  Chart error{name + "_error",
              "Error of " + probe.name + " against load" + suffix(part),
              "Relative error, value over truth less one; above zero: too large.",
              "load [N]",
              "error [%]",
              false,
              false,
              true,
              {}};
  Series truth{probe.reference ? probe.reference->label : "", Series::Style::truth, 0, {}, {}, {}, true};
  for (const RunSpec& run : scene.runs) {
    Series values{run.label, Series::Style::run, colour_of(run.label), {}, {}, {}, true}, errors = values;
    Cases along = finest(select(cases, run, part));
    std::stable_sort(along.begin(), along.end(), [](const CaseResult* a, const CaseResult* b) {
      return a->point.at("load") < b->point.at("load");
    });
    if (swept(scene, "dx").size() > 1 && !along.empty())
      values.label = errors.label = fmt::format("{}, dx {:g} mm", run.label, along[0]->dx * 1e3);
    for (const CaseResult* c : along) {
      const Measured* m = measured(*c, probe);
      if (!m) continue;
      const double load = c->point.at("load");
      if (c->broke) values.broke_x.push_back(load), errors.broke_x.push_back(load);
      if (m->value) values.x.push_back(load), values.y.push_back(*m->value * unit.factor);
      if (const auto e = relative_error(*m)) errors.x.push_back(load), errors.y.push_back(*e * 100);
      if (m->reference && std::find(truth.x.begin(), truth.x.end(), load) == truth.x.end())
        truth.x.push_back(load), truth.y.push_back(*m->reference * unit.factor);
    }
    if (values.x.empty() && values.broke_x.empty()) continue;
    value.series.push_back(std::move(values));
    error.series.push_back(std::move(errors));
  }
  for (const PrintedSpec& printed : probe.printed) {
    // Black where it belongs to no one run.
    Series marks{printed.label, Series::Style::printed, -1, {}, {}, {}, true}, errors = marks;
    if (!printed.runs.empty()) marks.colour = errors.colour = colour_of(printed.runs[0]);
    for (std::size_t i = 0; i < truth.x.size(); ++i) {
      SweepPoint point = part;
      point["load"] = truth.x[i];
      const PrintedValue p = printed_value(probe, printed, point);
      if (!p.value) continue;
      marks.x.push_back(truth.x[i]), marks.y.push_back(*p.value * unit.factor);
      errors.x.push_back(truth.x[i]), errors.y.push_back((*p.value * unit.factor / truth.y[i] - 1) * 100);
    }
    if (marks.x.empty()) continue;
    value.series.push_back(std::move(marks));
    error.series.push_back(std::move(errors));
  }
  const bool known = !truth.x.empty();
  if (known) {
    std::vector<std::size_t> order(truth.x.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return truth.x[a] < truth.x[b]; });
    Series sorted = truth;
    for (std::size_t i = 0; i < order.size(); ++i)
      sorted.x[i] = truth.x[order[i]], sorted.y[i] = truth.y[order[i]];
    value.series.insert(value.series.begin(), std::move(sorted));
  }
  charts.push_back(std::move(value));
  if (known) charts.push_back(std::move(error));
}

double largest_load(const Scene& scene) {
  double largest = 0;
  for (const double load : swept(scene, "load")) largest = std::max(largest, std::abs(load));
  return largest;
}

/// Size of the error against spacing, with lines of first and second order.
void add_spacing_chart(const Scene& scene, const std::vector<CaseResult>& cases, const ProbeSpec& probe,
                       const SweepPoint& part, std::vector<Chart>& charts) {
  Chart chart{file_name_of(scene.name + ' ' + probe.name + " dx " + describe(part)),
              "Error of " + probe.name + " against spacing" + suffix(part),
              "Size of the relative error. Dashed: first and second order.",
              "dx [mm]",
              "|error| [%]",
              true,
              true,
              false,
              {}};
  double x_max = 0, y_max = 0, x_min = 1e300;
  for (const RunSpec& run : scene.runs) {
    Series s{run.label, Series::Style::run, colour_of(run.label), {}, {}, {}, true};
    Cases along = select(cases, run, part);
    std::stable_sort(along.begin(), along.end(),
                     [](const CaseResult* a, const CaseResult* b) { return a->dx < b->dx; });
    for (const CaseResult* c : along) {
      const Measured* m = measured(*c, probe);
      if (c->broke && m) s.broke_x.push_back(c->dx * 1e3);
      const auto e = m ? relative_error(*m) : std::nullopt;
      if (!e || *e == 0) continue;
      s.x.push_back(c->dx * 1e3), s.y.push_back(std::abs(*e) * 100);
      x_max = std::max(x_max, s.x.back());
      x_min = std::min(x_min, s.x.back());
      y_max = std::max(y_max, s.y.back());
    }
    if (!s.x.empty() || !s.broke_x.empty()) chart.series.push_back(std::move(s));
  }
  if (y_max == 0) return;
  for (const double dx : swept(scene, "dx")) chart.x_ticks.push_back(dx * 1e3);
  for (const int order : {1, 2})
    if (x_min < x_max)
      chart.series.push_back({order == 1 ? "first order" : "second order",
                              Series::Style::guide,
                              0,
                              {x_min, x_max},
                              {y_max * std::pow(x_min / x_max, order), y_max},
                              {},
                              false});
  charts.push_back(std::move(chart));
}

/// Error against cost: one point for each run and spacing.
void add_cost_chart(const Scene& scene, const std::vector<CaseResult>& cases, std::vector<Chart>& charts) {
  Chart chart{file_name_of(scene.name + " cost"),
              "Error against loop time",
              "Each mark is one run at one spacing: root mean square of its relative errors over the cases "
              "it finished, against the "
              "mean wall time of their time loops. Down and left is better. Crosses along the lower edge: "
              "broke in every "
              "case, after that long.",
              "loop time a case [s]",
              "error, rms [%]",
              true,
              true,
              false,
              {}};
  bool any_error = false;
  for (const RunSpec& run : scene.runs) {
    std::set<double, std::greater<>> spacings;
    std::size_t total = 0, broke = 0;
    for (const CaseResult& c : cases)
      if (c.run == &run) {
        spacings.insert(c.dx);
        ++total;
        broke += c.broke;
      }
    Series s{broke ? fmt::format("{} (broke in {} of {})", run.label, broke, total) : run.label,
             Series::Style::run,
             colour_of(run.label),
             {},
             {},
             {},
             true};
    for (const double dx : spacings) {
      Cases same;
      double loop = 0;
      for (const CaseResult& c : cases)
        if (c.run == &run && c.dx == dx && !c.broke) same.push_back(&c), loop += c.loop_s;
      if (same.empty())  // never came to an end: how long it tried
        for (const CaseResult& c : cases)
          if (c.run == &run && c.dx == dx && c.loop_s > 0) s.broke_x.push_back(c.loop_s);
      const auto error = rms_error(same);
      if (!error || *error == 0 || loop == 0) continue;
      s.x.push_back(loop / static_cast<double>(same.size()));
      s.y.push_back(*error * 100);
    }
    any_error = any_error || !s.x.empty();
    if (!s.x.empty() || !s.broke_x.empty()) chart.series.push_back(std::move(s));
  }
  if (any_error) charts.push_back(std::move(chart));
}

/// What a probe samples, and where: "Cauchy stress xx at (60, 25) mm".
std::string signal(const ProbeSpec& probe) {
  const auto axis = [](int number) { return std::string(1, static_cast<char>('x' + number)); };
  std::string text = probe.type;
  std::replace(text.begin(), text.end(), '_', ' ');
  if (probe.type == "cauchy_stress")
    text = "Cauchy stress " + axis(probe.row) + axis(probe.column);
  else if (probe.type == "von_mises")
    text = "von Mises stress";
  else if (probe.type != "pressure" && probe.type != "kinetic_energy" && probe.type != "strain_energy")
    text += ' ' + axis(probe.row);
  for (std::size_t d = 0; d < probe.at.size(); ++d)
    text += fmt::format("{}{:g}", d ? ", " : " at (", probe.at[d] * 1e3);
  return text + (probe.at.empty() ? "" : ") mm");
}

/// A probe over time under every run, with the exact curve.
void add_history_chart(const Scene& scene, const std::vector<CaseResult>& cases, const ProbeSpec& probe,
                       const SweepPoint& point, std::vector<Chart>& charts) {
  Cases along;
  for (const CaseResult& c : cases)
    if (c.point == point)
      if (const Measured* m = measured(c, probe); m && !m->history.t.empty()) along.push_back(&c);
  if (along.empty()) return;
  const bool only_broken =
      std::all_of(along.begin(), along.end(), [](const CaseResult* c) { return c->broke; });
  double size = 0, duration = 0;
  for (const CaseResult* c : along)
    for (std::size_t i = 0; i < measured(*c, probe)->history.t.size(); ++i) {
      const double v = std::abs(measured(*c, probe)->history.value[i]);
      if (std::isfinite(v) && (!c->broke || only_broken)) size = std::max(size, v);
      duration = std::max(duration, measured(*c, probe)->history.t[i]);
    }
  const bool any_broke =
      std::any_of(along.begin(), along.end(), [](const CaseResult* c) { return c->broke; });
  const ShownUnit unit = shown_unit(probe.signal_unit(), size), time = shown_unit("s", duration);
  Chart chart{file_name_of(scene.name + ' ' + probe.name + " history " + describe(point)),
              signal(probe) + " over time" + suffix(point),
              any_broke ? "Crosses along the lower edge: the run broke at this time; its curve ends there, "
                          "or leaves the chart."
                        : "",
              "time [" + time.name + "]",
              fmt::format("{} [{}]", signal(probe).substr(0, signal(probe).find(" at ")), unit.name),
              false,
              false,
              true,
              {}};
  const auto scaled = [&](const Curve& curve, Series s) {
    for (std::size_t i = 0; i < curve.t.size(); ++i)
      s.x.push_back(curve.t[i] * time.factor), s.y.push_back(curve.value[i] * unit.factor);
    return s;
  };
  if (const Curve& exact = measured(*along[0], probe)->exact; !exact.t.empty())
    chart.series.push_back(
        scaled(exact, {probe.reference->label, Series::Style::truth, 0, {}, {}, {}, false}));
  for (const CaseResult* c : along) {
    Series s{c->run->label, Series::Style::run, colour_of(c->run->label), {}, {}, {}, false};
    s.wild = c->broke;
    if (c->broke) s.broke_x.push_back(c->broke_time * time.factor);
    chart.series.push_back(scaled(measured(*c, probe)->history, std::move(s)));
  }
  charts.push_back(std::move(chart));
}

}  // namespace

std::optional<double> shared_error(const Measured& m) {
  const OnlySpec& only = m.probe->only;
  return only.runs.empty() && only.formulations.empty() ? relative_error(m) : std::nullopt;
}

std::optional<double> rms_error(const std::vector<const CaseResult*>& cases) {
  double sum = 0;
  int count = 0;
  for (const CaseResult* c : cases)
    for (const Measured& m : c->measured)
      if (const auto e = shared_error(m)) {
        sum += *e * *e;
        ++count;
      }
  if (!count) return {};
  return std::sqrt(sum / count);
}

std::vector<Chart> charts_of(const Scene& scene, const std::vector<CaseResult>& cases) {
  std::vector<Chart> charts;
  const bool loads = swept(scene, "load").size() > 1, spacings = swept(scene, "dx").size() > 1;
  for (const ProbeSpec& probe : scene.probes) {
    if (loads)
      for (const SweepPoint& part : others(scene, {"load", "dx"}))
        add_load_charts(scene, cases, probe, part, charts);
    if (spacings)
      for (const SweepPoint& part : others(scene, {"dx"}))
        if (!loads || std::abs(part.at("load")) == largest_load(scene))
          add_spacing_chart(scene, cases, probe, part, charts);
    // Probes that measure the same signal share a chart, that of the one with a curve to compare with.
    const auto same = [&](const ProbeSpec& other) { return signal(other) == signal(probe); };
    const auto shown = std::find_if(scene.probes.begin(), scene.probes.end(), [&](const ProbeSpec& other) {
      return same(other) && other.reference && other.reference->analytic == "neo_hookean_stretch";
    });
    const auto first = std::find_if(scene.probes.begin(), scene.probes.end(), same);
    if (&probe == &*(shown != scene.probes.end() ? shown : first))
      for (const SweepPoint& point : scene.points()) add_history_chart(scene, cases, probe, point, charts);
  }
  add_cost_chart(scene, cases, charts);
  std::erase_if(charts, [](const Chart& chart) { return chart.empty(); });
  return charts;
}

}  // namespace taut::bench
