#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/files.hpp>
#include <lib/health_table.hpp>
#include <lib/html.hpp>
#include <lib/names.hpp>
#include <lib/picture.hpp>
#include <lib/reference.hpp>
#include <lib/report.hpp>
#include <lib/scene_charts.hpp>
#include <lib/text_table.hpp>
#include <lib/view.hpp>

namespace taut::bench {
namespace {

using Cells = std::vector<HtmlCell>;

std::string percent(double error) { return signed_percent(error, 2); }
const char* name_of(Lattice kind) { return kind == Lattice::node_centred ? "node-centred" : "cell-centred"; }

std::string duration(double seconds) {
  if (seconds < 0.1) return fmt::format("{:.1f} ms", seconds * 1e3);
  if (seconds < 100) return fmt::format("{:.2f} s", seconds);
  return fmt::format("{:.0f} s", seconds);
}

/// All cases of one run at one spacing.
struct Group {
  const RunSpec* run;
  double dx;
  std::vector<const CaseResult*> cases;
};

std::vector<Group> groups_of(const SceneReport& part) {
  std::vector<Group> groups;
  for (const RunSpec& run : part.scene->runs)
    for (const CaseResult& c : part.cases)
      if (c.run == &run) {
        auto found = std::find_if(groups.begin(), groups.end(),
                                  [&](const Group& g) { return g.run == &run && g.dx == c.dx; });
        if (found == groups.end()) found = groups.insert(groups.end(), Group{&run, c.dx, {}});
        found->cases.push_back(&c);
      }
  return groups;
}

struct Summary {
  std::size_t broke = 0, suspect = 0;
  double loop_s = 0, particle_steps = 0;
  std::optional<double> worst;
  std::optional<double> rms;
};

Summary summarise(const Group& group) {
  Summary s;
  for (const CaseResult* c : group.cases) {
    s.broke += c->broke;
    s.suspect += c->suspect();
    s.loop_s += c->loop_s;
    s.particle_steps += static_cast<double>(c->particles) * static_cast<double>(c->steps);
    for (const Measured& m : c->measured)
      if (const auto e = shared_error(m))
        if (!s.worst || std::abs(*e) > std::abs(*s.worst)) s.worst = e;
  }
  s.rms = rms_error(group.cases);
  return s;
}

/// The cheapest run that finishes every case within the wanted accuracy.
std::string verdict(const SceneReport& part) {
  const double wanted = part.scene->accuracy;
  const Group* best = nullptr;
  double best_time = 0;
  bool any_truth = false;
  const std::vector<Group> groups = groups_of(part);
  for (const Group& group : groups) {
    const Summary s = summarise(group);
    any_truth = any_truth || s.worst;
    if (s.broke || s.suspect || !s.worst || std::abs(*s.worst) > wanted) continue;
    if (!best || s.loop_s < best_time) best = &group, best_time = s.loop_s;
  }
  if (!any_truth) return "The scene names no truth to compare with.";
  if (!best)
    return fmt::format("No run that is not suspect finishes every case within {:g} % of the truth.",
                       wanted * 100);
  return fmt::format(
      "Cheapest run that finishes every case within {:g} % of the truth, none of them suspect: {} at dx {:g} "
      "mm, {} in its time "
      "loops.",
      wanted * 100, best->run->label, best->dx * 1e3, duration(best_time));
}

void write_runs(HtmlPage& page, const SceneReport& part) {
  page.heading(3, "Runs");
  std::vector<Cells> rows;
  for (const Group& group : groups_of(part)) {
    const Summary s = summarise(group);
    const CaseResult& first = *group.cases.front();
    const Method& m = group.run->method;
    const std::size_t total = group.cases.size();
    const std::string lattice =
        part.scene->geometry.type == "csv" ? "from file" : name_of(group.run->lattice.kind);
    rows.push_back(
        {{group.run->label, run_colour(colour_of(group.run->label))},
         {s.broke     ? fmt::format("{} of {} broke", s.broke, total)
          : s.suspect ? fmt::format("{} of {} suspect", s.suspect, total)
                      : fmt::format("all {} finished", total),
          s.broke || s.suspect ? "bad" : "good"},
         {s.rms ? fmt::format("{:.2f} %", 100 * *s.rms) : "–", "number"},
         {s.worst ? percent(*s.worst) : "–", "number"},
         {duration(s.loop_s), "number"},
         {s.loop_s > 0 ? fmt::format("{:.1f}", s.particle_steps / s.loop_s * 1e-6) : "", "number"},
         {group.dx > 0 ? fmt::format("{:g}", group.dx * 1e3) : "", "number"},
         {fmt::format("{}", first.particles), "number"},
         {m.formulation + (has_operators(m.formulation) ? ", " + m.operators : ""), "wrap"},
         {first.material, "wrap"},
         {has_pairs(m.formulation) ? fmt::format("{}, {}, {:g} dx", lattice, m.kernel, m.support_dx)
                                   : lattice,
          "wrap"}});
  }
  page.table({"run", "outcome", "rms error", "worst error", "loop time", "M steps/s", "dx [mm]", "particles",
              "formulation, operators", "material", "lattice, kernel, support radius"},
             rows);
  page.paragraph(
      "Errors are relative to the truth (value over truth less one), over the cases that finished and the "
      "quantities that all "
      "runs share. Loop time: wall time of all time loops of a run, set-up left out. M steps/s: million "
      "particle-steps a second.",
      "quiet");
}

/// Why runs with formulation = "auto" are as they are.
void write_automatic(HtmlPage& page, const SceneReport& part) {
  for (const RunSpec& run : part.scene->runs) {
    if (run.automatic.empty()) continue;
    std::vector<Cells> rows;
    for (const FiredRule& rule : run.automatic)
      rows.push_back({{rule.sets.empty() ? "note" : rule.sets, ""}, {rule.when, "wrap"}, {rule.why, "wide"}});
    page.heading(3, fmt::format("How the method of the run '{}' was chosen", run.label));
    page.table({"chosen", "because", "why"}, rows);
  }
}

void write_broken(HtmlPage& page, const SceneReport& part) {
  std::vector<Cells> rows;
  for (const CaseResult& c : part.cases)
    if (c.broke)
      rows.push_back({{c.run->label, run_colour(colour_of(c.run->label))},
                      {describe(c.point), ""},
                      {fmt::format("{:.4g} s", c.broke_time), "number bad"},
                      {fmt::format("{}", c.steps), "number"},
                      {c.what + (c.where.empty() ? "" : "; " + c.where), "wide"}});
  page.heading(3, "Which broke, and when");
  if (rows.empty()) return page.paragraph("None: every case finished.");
  page.table({"run", "case", "broke at", "step", "what happened"}, rows);
}

/// Truth, ours and what sources printed, side by side.
void write_values(HtmlPage& page, const SceneReport& part, const ProbeSpec& probe) {
  std::vector<Group> groups = groups_of(part);
  const bool one_dx = groups.size() == part.scene->runs.size();
  std::erase_if(groups, [&](const Group& g) {
    return std::none_of(g.cases.begin(), g.cases.end(), [&](const CaseResult* c) {
      return std::any_of(c->measured.begin(), c->measured.end(),
                         [&](const Measured& m) { return m.probe == &probe; });
    });
  });
  const double factor = probe.unit() == "m" ? 1e3 : 1;
  std::vector<std::string> header = {"case"};
  if (probe.reference) header.push_back(probe.reference->label);
  for (const Group& g : groups)
    header.push_back(one_dx ? g.run->label : fmt::format("{}, dx {:g} mm", g.run->label, g.dx * 1e3));
  for (const PrintedSpec& p : probe.printed) header.push_back(p.label);
  std::vector<Cells> rows;
  std::vector<SweepPoint> points;
  for (SweepPoint point : part.scene->points()) {
    point.erase("dx");
    if (std::find(points.begin(), points.end(), point) == points.end()) points.push_back(point);
  }
  const auto shown = [&](double value, std::optional<double> truth) {
    std::string text = fmt::format("{:.4g}", value * factor);
    if (truth && *truth != 0) text += " (" + signed_percent(value / *truth - 1, 1) + ')';
    return text;
  };
  for (const SweepPoint& point : points) {
    Cells row = {{describe(point).empty() ? "–" : describe(point), ""}};
    std::optional<double> truth;
    Cells ours;
    for (const Group& g : groups) {
      HtmlCell cell{"–", "number quiet"};
      for (const CaseResult* c : g.cases) {
        SweepPoint rest = c->point;
        rest.erase("dx");
        if (rest != point) continue;
        for (const Measured& m : c->measured) {
          if (m.probe != &probe) continue;
          if (m.reference) truth = m.reference;
          if (c->broke)
            cell = {"broke", "number bad"};
          else if (m.value)
            cell = {shown(*m.value, m.reference), "number"};
        }
      }
      ours.push_back(std::move(cell));
    }
    if (probe.reference) row.push_back({truth ? fmt::format("{:.4g}", *truth * factor) : "–", "number"});
    row.insert(row.end(), ours.begin(), ours.end());
    for (const PrintedSpec& p : probe.printed) {
      const PrintedValue v = printed_value(probe, p, point);
      if (v.broke)
        row.push_back({"broke", "number bad"});
      else if (v.value)
        row.push_back({shown(*v.value, truth), "number"});
      else
        row.push_back({"–", "number quiet"});
    }
    rows.push_back(std::move(row));
  }
  const std::string unit = probe.unit() == "m" ? "mm" : probe.unit();
  page.heading(3, probe.name + (unit == "1" ? "" : " [" + unit + "]") +
                      (probe.printed.empty() ? "" : ", and what the source printed"));
  page.table(header, rows);
  if (probe.reference) page.paragraph("In brackets: relative error against the truth.", "quiet");
}

void write_charts(HtmlPage& page, const SceneReport& part, const std::filesystem::path& out,
                  std::vector<std::string>& missing) {
  for (const Chart& chart : charts_of(*part.scene, part.cases)) add_chart(page, chart, out, missing);
}

void write_pictures(HtmlPage& page, const SceneReport& part, const std::filesystem::path& out,
                    std::vector<std::string>& missing) {
  const std::vector<SweepPoint> points = part.scene->points();
  for (std::size_t i = 0; i < part.scene->pictures.size(); ++i) {
    const PictureSpec& picture = part.scene->pictures[i];
    const SweepPoint& point = points[nearest_point(points, picture.of)];
    std::vector<const CaseResult*> cases;
    for (const CaseResult& c : part.cases)
      if (c.point == point && c.snapshot && shows(picture, *c.run)) cases.push_back(&c);
    if (cases.empty()) continue;
    const std::string name =
        part.scene->name + (part.scene->pictures.size() > 1 ? fmt::format("_{}", i + 1) : "") + ".png";
    make_folder(out / "pictures");
    std::string why;
    if (write_picture(picture, cases, out / "pictures" / name, why))
      page.figure(out / "pictures" / name,
                  picture.title +
                      ". Particles at their deformed places, coloured by stress; dashed: the "
                      "undeformed outline. A run that broke is shown in its last good state." +
                      (part.scene->dimension == 3 && !View(picture.from).is_straight()
                           ? " Faces seen at a slant are darker where light falls on them less."
                           : ""));
    else {
      missing.push_back("pictures/" + name + ": " + why);
      page.paragraph(fmt::format("{}: no picture ({}).", picture.title, why), "quiet");
    }
  }
}

void write_cases(const Report& report, const std::filesystem::path& out) {
  std::string text =
      "scene,run,formulation,lattice,jitter,dx,load,nu,region_density,status,broke_time,what,steps,time,loop_"
      "s\n";
  for (const SceneReport& part : report.scenes)
    for (const CaseResult& c : part.cases) {
      const auto value = [&](const char* key) {
        return c.point.contains(key) ? fmt::format("{}", c.point.at(key)) : std::string();
      };
      const auto quoted = [](std::string s) {
        std::replace(s.begin(), s.end(), '"', '\'');
        return '"' + s + '"';
      };
      text +=
          fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", part.scene->name,
                      quoted(c.run->label), c.run->method.formulation, name_of(c.run->lattice.kind),
                      c.run->lattice.jitter, c.dx, value("load"), value("nu"), value("region_density"),
                      c.broke       ? "broke"
                      : c.suspect() ? "suspect"
                                    : "ok",
                      c.broke ? fmt::format("{}", c.broke_time) : "",
                      quoted(c.what + (c.where.empty() ? "" : "; " + c.where)), c.steps, c.time, c.loop_s);
    }
  write_file(out / "cases.csv", text);
}

}  // namespace

void add_chart(HtmlPage& page, const Chart& chart, const std::filesystem::path& out,
               std::vector<std::string>& missing) {
  std::string why;
  if (write_chart(chart, out / "charts", why))
    return page.figure(out / "charts" / (chart.name + ".svg"), chart.title + ". " + chart.caption);
  missing.push_back("charts/" + chart.name + ".svg: " + why);
  page.paragraph(
      fmt::format("{}: no chart ({}); its numbers are in charts/{}.csv.", chart.title, why, chart.name),
      "quiet");
}

namespace {

void write_page(const Report& report, const std::filesystem::path& out, bool figures,
                std::vector<std::string>& missing) {
  const bool one = report.scenes.size() == 1;
  HtmlPage page(one ? report.scenes[0].scene->title
                    : fmt::format("{}: {} scenes", report.executable, report.scenes.size()));
  std::size_t total = 0, broke = 0;
  for (const SceneReport& part : report.scenes)
    for (const CaseResult& c : part.cases) ++total, broke += c.broke;
  for (const SceneReport& part : report.scenes)
    for (const RunSpec& run : part.scene->runs) colour_of(run.label);  // in their order
  page.paragraph(
      fmt::format("{} {}: {} cases, {} finished and {} broke, in {:.0f} s on {} thread{}{}.",
                  report.executable, TAUT_VERSION, total, total - broke, broke, std::ceil(report.wall_s),
                  report.threads, report.threads == 1 ? "" : "s",
                  report.quick ? ". This is the quick version (--quick): coarser, and with fewer cases" : ""),
      "quiet");
  if (report.unfinished)
    page.paragraph(fmt::format("The job was interrupted: {} of {} cases were not run.", report.unfinished,
                               total + report.unfinished),
                   "lead");
  for (const SceneReport& part : report.scenes) {
    if (!one) page.heading(2, part.scene->title);
    if (!part.scene->description.empty()) page.paragraph(part.scene->description);
    page.paragraph(verdict(part), "lead");
    if (figures) write_pictures(page, part, out, missing);
    write_runs(page, part);
    write_health(page, part);
    write_automatic(page, part);
    if (figures) write_charts(page, part, out, missing);
    write_broken(page, part);
    for (const ProbeSpec& probe : part.scene->probes) write_values(page, part, probe);
    page.paragraph(fmt::format("Scene file: {}. The numbers are in results.csv (one row a quantity) and "
                               "cases.csv; deformed bodies for ParaView "
                               "in fields/.",
                               part.scene->file),
                   "quiet");
  }
  write_file(out / "report.html", page.str());
}

}  // namespace

std::vector<std::string> write_report(const Report& report, const std::filesystem::path& out) {
  std::vector<std::string> missing;
  write_cases(report, out);
  // Drawing may take its time, or be interrupted: the numbers first.
  write_page(report, out, false, missing);
  write_page(report, out, true, missing);
  return missing;
}

}  // namespace taut::bench
