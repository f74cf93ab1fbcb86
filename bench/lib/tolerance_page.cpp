#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/chart.hpp>
#include <lib/files.hpp>
#include <lib/report.hpp>
#include <lib/text_table.hpp>
#include <lib/tolerance.hpp>

namespace taut::bench {
namespace {

using Cells = std::vector<HtmlCell>;

HtmlCell number(const std::string& text) { return {text, text == "–" ? "number quiet" : "number"}; }

/// The pilot at a spacing, not a later verification there.
const Sample* pilot(const Candidate& c, double dx) {
  for (const Sample& s : c.samples)
    if (s.dx == dx && !s.verification) return &s;
  return nullptr;
}

const Sample* verification(const Candidate& c) {
  const Sample* last = nullptr;
  for (const Sample& s : c.samples)
    if (s.verification) last = &s;
  return last;
}

TextTable summary(const ToleranceResult& r) {
  TextTable table{
      fmt::format("{}: candidates for {:g} %", r.scene->name, 100 * r.tolerance),
      "Errors: the largest over all probes and swept points. Order: seen between the two spacings that "
      "the prediction rests on. Seconds: set-up and time loops of all swept points.",
      {"candidate"},
      {}};
  for (const double dx : r.pilot_dx)
    table.header.push_back(dx > 0 ? fmt::format("error at {:.3g} mm", dx * 1e3) : "error");
  for (const char* name :
       {"order", "dx [mm]", "predicted error", "predicted s", "verified error", "verified s", ""})
    table.header.emplace_back(name);
  for (std::size_t i = 0; i < r.candidates.size(); ++i) {
    const Candidate& c = r.candidates[i];
    const bool chosen = r.met && static_cast<int>(i) == r.chosen;
    Cells row = {{c.run.label, run_colour(colour_of(c.run.label))}};
    for (const double dx : r.pilot_dx) {
      const Sample* s = pilot(c, dx);
      row.push_back(number(s && s->error ? fmt::format("{:.3g} %", 100 * *s->error) : "–"));
    }
    const std::optional<Prediction> p = chosen ? r.promised : c.prediction;
    const bool several = p && p->order && std::isfinite(*p->order);
    row.push_back(number(several ? fmt::format("{:.2f}", *p->order) : "–"));
    row.push_back(number(p && p->dx > 0 ? fmt::format("{:.4g}", p->dx * 1e3) : "–"));
    row.push_back(number(p ? fmt::format("{:.3g} %", 100 * p->error) : "–"));
    row.push_back(number(p ? fmt::format("{:.3g}", p->seconds) : "–"));
    const Sample* v = chosen ? r.best : verification(c);
    row.push_back(number(v && v->error ? fmt::format("{:.3g} %", 100 * *v->error) : "–"));
    row.push_back(number(v ? fmt::format("{:.3g}", v->seconds()) : "–"));
    row.push_back({chosen ? "chosen" : c.out, chosen ? "good" : c.out.empty() ? "" : "wrap quiet"});
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Every value that was measured, with what it was held against.
TextTable values(const ToleranceResult& r) {
  TextTable table{
      "What the pilots gave", "", {"candidate", "dx [mm]", "quantity", "value", "truth", "error", "s"}, {}};
  for (const Candidate& c : r.candidates)
    for (const Sample& s : c.samples)
      for (const CaseResult& result : s.cases) {
        SweepPoint point = result.point;
        point.erase("dx");
        for (const Measured& m : result.measured) {
          if (!m.value) continue;
          const auto truth = r.truths.of.find({m.probe, point});
          const bool has = truth != r.truths.of.end();
          table.rows.push_back({{c.run.label + (s.verification ? ", verification" : ""), ""},
                                number(s.dx > 0 ? fmt::format("{:.4g}", s.dx * 1e3) : "–"),
                                {m.probe->name + (point.empty() ? "" : ", " + describe(point)), "wrap"},
                                number(fmt::format("{:.5g} {}", *m.value, m.probe->unit())),
                                number(has ? fmt::format("{:.5g}{}", truth->second.value,
                                                         truth->second.votes ? " (extrapolated)" : "")
                                           : "–"),
                                number(has ? signed_percent(*m.value / truth->second.value - 1, 2) : "–"),
                                number(fmt::format("{:.3g}", result.setup_s + result.loop_s))});
        }
      }
  return table;
}

Chart chart_of(const ToleranceResult& r) {
  Chart chart{r.scene->name + "_tolerance",
              fmt::format("{}: error against time", r.scene->title),
              "Each mark is one candidate at one spacing: the largest relative error over all probes and "
              "swept points, "
              "against the seconds that these took. Dashed: the wanted tolerance. Verifying runs stand with "
              "the pilots.",
              "set-up and loops [s]",
              "|error| [%]",
              true,
              true,
              false,
              {}};
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (std::size_t i = 0; i < r.candidates.size(); ++i) {
    Series series{r.candidates[i].run.label,
                  Series::Style::run,
                  colour_of(r.candidates[i].run.label),
                  {},
                  {},
                  {},
                  true};
    for (const Sample& s : r.candidates[i].samples) {
      if (!s.error || *s.error <= 0) continue;
      series.x.push_back(s.seconds());
      series.y.push_back(100 * *s.error);
      least = std::min(least, s.seconds());
      most = std::max(most, s.seconds());
    }
    if (!series.x.empty()) chart.series.push_back(std::move(series));
  }
  if (most > 0)
    chart.series.push_back({fmt::format("{:g} %", 100 * r.tolerance),
                            Series::Style::guide,
                            0,
                            {least, most},
                            {100 * r.tolerance, 100 * r.tolerance},
                            {},
                            false});
  return chart;
}

/// Where the truth comes from, and what could not take part.
std::vector<std::string> remarks(const ToleranceResult& r) {
  std::vector<std::string> all;
  std::size_t extrapolated = 0;
  int votes = 0;
  for (const auto& [quantity, truth] : r.truths.of) {
    extrapolated += truth.votes > 0;
    if (truth.votes > 0) votes = votes == 0 ? truth.votes : std::min(votes, truth.votes);
  }
  if (extrapolated > 0)
    all.push_back(fmt::format(
        "Without reference: {} of {} quantities. Their truth is the median of the candidates' Richardson "
        "extrapolations over three spacings ({} or more each), which differ by up to {:.2g} %.",
        extrapolated, r.truths.of.size(), votes, 100 * r.truths.spread()));
  for (const std::string& untold : r.truths.untold)
    all.push_back("Left out, for want of a truth: " + untold + ".");
  for (const std::string& note : r.notes) all.push_back("No candidate: " + note + ".");
  return all;
}

}  // namespace

std::string plain_summary(const ToleranceResult& result) {
  std::string text = plain(summary(result));
  for (const std::string& remark : remarks(result)) text += "  " + remark + '\n';
  return text;
}

std::vector<std::string> write_tolerance_page(const std::vector<ToleranceResult>& results,
                                              const CommonOptions& common) {
  std::vector<std::string> missing;
  HtmlPage page("The cheapest method that is accurate enough");
  page.paragraph(fmt::format("taut-compare {} --tolerance {:g}%, {} thread{}{}.", TAUT_VERSION,
                             100 * results.front().tolerance, common.threads, common.threads == 1 ? "" : "s",
                             common.quick ? ". This is the quick version (--quick)" : ""),
                 "quiet");
  for (const ToleranceResult& r : results) {
    page.heading(2, r.scene->title);
    page.paragraph(r.verdict(), "lead");
    const TextTable table = summary(r);
    page.table(table.header, table.rows);
    page.paragraph(table.note, "quiet");
    for (const std::string& remark : remarks(r)) page.paragraph(remark);
    const Chart chart = chart_of(r);
    if (!chart.empty()) add_chart(page, chart, common.out, missing);
    const TextTable all = values(r);
    page.begin_details(all.title);
    page.table(all.header, all.rows);
    page.end_details();
  }
  page.paragraph("The numbers are in results.csv: quantities pilot_…, missed_… and chosen_….", "quiet");
  write_file(common.out / "report.html", page.str());
  return missing;
}

}  // namespace taut::bench
