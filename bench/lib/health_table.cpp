#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/health_table.hpp>
#include <lib/scene_charts.hpp>

namespace taut::bench {
namespace {

/// Whether a is the worse one of two values of a measure.
bool worse(const HealthMeasure& a, const HealthMeasure& b) {
  if (a.flagged() != b.flagged()) return a.flagged();
  return a.from_below ? a.value < b.value : a.value > b.value;
}

std::string title_of(const std::string& name) {
  std::string title = name.starts_with("health_") ? name.substr(7) : name;
  std::replace(title.begin(), title.end(), '_', ' ');
  return title;
}

HtmlCell cell_of(const HealthMeasure& m) {
  const std::string text = fmt::format("{:.2g}", m.value);
  if (m.flagged()) return {text, "number bad"};
  if (!std::isfinite(m.limit)) return {text, "number"};
  const bool near = m.from_below ? m.value < 2 * m.limit : m.value > 0.5 * m.limit;
  return {text, near ? "number fair" : "number good"};
}

std::string limit_of(const HealthMeasure& m) {
  if (!std::isfinite(m.limit)) return "–";
  return fmt::format("{} {:g}", m.from_below ? "≥" : "≤", m.limit);
}

}  // namespace

void write_health(HtmlPage& page, const SceneReport& part) {
  std::vector<HealthMeasure> columns;  // the worst of all cases
  std::vector<std::pair<const RunSpec*, std::vector<HealthMeasure>>> runs;
  for (const CaseResult& c : part.cases) {
    if (runs.empty() || runs.back().first != c.run) runs.push_back({c.run, {}});
    for (std::vector<HealthMeasure>* into : {&columns, &runs.back().second})
      for (const HealthMeasure& m : c.health.measures) {
        const auto found = std::find_if(into->begin(), into->end(),
                                        [&](const HealthMeasure& o) { return o.name == m.name; });
        if (found == into->end())
          into->push_back(m);
        else if (worse(m, *found))
          *found = m;
      }
  }
  if (columns.empty()) return;
  std::vector<std::string> header = {"run"};
  for (const HealthMeasure& m : columns) header.push_back(title_of(m.name));
  std::vector<std::vector<HtmlCell>> rows;
  for (const auto& [run, measures] : runs) {
    std::vector<HtmlCell> row = {{run->label, run_colour(colour_of(run->label))}};
    for (const HealthMeasure& column : columns) {
      const auto found = std::find_if(measures.begin(), measures.end(),
                                      [&](const HealthMeasure& m) { return m.name == column.name; });
      row.push_back(found == measures.end() ? HtmlCell{"", "number quiet"} : cell_of(*found));
    }
    rows.push_back(std::move(row));
  }
  page.heading(3, "Health: can these runs be trusted?");
  page.table(header, rows);
  page.paragraph(
      "The worst of each run's cases. Red is beyond the limit: the run is suspect, and its answer may be "
      "wrong by more than "
      "10 %; without a colour is what has no limit. Green is no proof.",
      "quiet");
  std::vector<std::vector<HtmlCell>> lines;
  for (const HealthMeasure& m : columns) {
    std::string where;
    if (m.particle >= 0) {
      where = fmt::format("particle {} at (", m.particle);
      for (int d = 0; d < part.scene->dimension; ++d)
        where += fmt::format("{}{:.4g}", d ? ", " : "", m.X[static_cast<std::size_t>(d)]);
      where += ')';
    }
    lines.push_back({{title_of(m.name), ""}, {limit_of(m), "number"}, {m.meaning, "wide"}, {where, ""}});
  }
  page.begin_details("What these measures mean, and where they are worst");
  page.table({"measure", "limit", "meaning", "worst at"}, lines);
  page.end_details();
}

}  // namespace taut::bench
