#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <lib/build.hpp>
#include <lib/files.hpp>
#include <lib/gnuplot.hpp>
#include <lib/progress.hpp>
#include <lib/results.hpp>
#include <lib/signals.hpp>
#include <lib/terminal.hpp>
#include <lib/tolerance.hpp>

namespace taut::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int verifications = 3;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Cells across the shortest edge at the coarsest pilot: about a quarter of the scene's, and an even number,
/// so that a node stays on the middle. Each further pilot doubles them.
double coarsest_cells(double edge, double dx) {
  const double cells = std::round(edge / dx);
  return std::max(cells < 8 ? 2.0 : 4.0, 2 * std::round(cells / 8));
}

/// One candidate at one spacing, at all points. Gives up, with `out` set, where it breaks, cannot run, or
/// takes longer than `budget` seconds.
void run_sample(const Scene& scene, Candidate& candidate, double dx, bool verification, double budget,
                ProgressLine& progress) {
  Sample sample;
  sample.dx = dx;
  sample.verification = verification;
  const auto start = Clock::now();
  candidate.broken.reset();
  for (SweepPoint point : points_without_dx(scene)) {
    if (dx > 0) point["dx"] = dx;
    bool gave_up = false;
    CaseOptions how;
    how.progress = [&](std::int64_t steps, double, double fraction) {
      progress.update(steps, fraction);
      gave_up = seconds_since(start) > budget;
      if (asked_to_stop()) throw Interrupted(asked_to_stop(), "interrupted");
      return !gave_up;
    };
    try {
      sample.cases.push_back(run_case(scene, candidate.run, point, how));
    } catch (const InputError& error) {
      candidate.out = fmt::format("cannot run at dx {:.3g} mm: {}", dx * 1e3, error.what());
      return;
    }
    const CaseResult& c = sample.cases.back();
    if (gave_up) {
      candidate.out = fmt::format("gave up at dx {:.3g} mm after {:.0f} s: far slower than others", dx * 1e3,
                                  seconds_since(start));
      return;
    }
    if (c.broke) {
      const std::string where = describe(point);
      candidate.out = fmt::format("broke{}: {}", where.empty() ? "" : " at " + where, c.what);
      candidate.broken = c;
      return;
    }
  }
  const auto place = std::find_if(candidate.samples.begin(), candidate.samples.end(),
                                  [&](const Sample& s) { return s.dx < dx; });
  candidate.samples.insert(place, std::move(sample));
}

double least_seconds(const std::vector<Candidate>& candidates, double dx) {
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& c : candidates)
    for (const Sample& s : c.samples)
      if (s.dx == dx) least = std::min(least, s.seconds());
  return least;
}

std::string outcome(const Candidate& candidate, double dx) {
  if (!candidate.out.empty()) return candidate.out;
  for (const Sample& s : candidate.samples)
    if (s.dx == dx)
      return fmt::format("{} particles, {:.3g} s in all", s.cases.front().particles, s.seconds());
  return "";
}

void run_pilots(ToleranceResult& r, ProgressLine& progress) {
  std::size_t item = 0;
  for (const double dx : r.pilot_dx)
    for (Candidate& c : r.candidates) {
      if (!c.out.empty()) {
        ++item;
        continue;
      }
      progress.begin(item++, dx > 0 ? fmt::format("pilot, {}, dx {:.3g} mm", c.run.label, dx * 1e3)
                                    : fmt::format("pilot, {}", c.run.label));
      // Updated Lagrangian relaxation may take a hundred times as long as the rest; that candidate is not
      // cheap.
      run_sample(*r.scene, c, dx, false, 2 + 30 * least_seconds(r.candidates, dx), progress);
      progress.end(outcome(c, dx));
    }
}

/// The sample nearest to the tolerance: what a message can offer where none meets it.
void find_nearest(ToleranceResult& r) {
  for (const bool suspects : {false, true}) {  // these only where there is nothing else
    if (r.best) return;
    for (std::size_t i = 0; i < r.candidates.size(); ++i)
      for (const Sample& s : r.candidates[i].samples)
        if (s.error && s.suspect() == suspects && (!r.best || *s.error < *r.best->error)) {
          r.best = &s;
          r.chosen = static_cast<int>(i);
        }
  }
}

void verify(ToleranceResult& r, double edge, double finest, ProgressLine& progress) {
  const std::size_t pilots = r.pilot_dx.size() * r.candidates.size();
  for (int i = 0; i < verifications && !r.met; ++i) {
    Candidate* c = cheapest(r.candidates);
    if (!c) break;
    const Prediction promised = *c->prediction;
    const bool again = std::any_of(c->samples.begin(), c->samples.end(),
                                   [&](const Sample& s) { return s.dx == promised.dx; });
    progress.begin(pilots, promised.dx > 0
                               ? fmt::format("verify, {}, dx {:.4g} mm", c->run.label, promised.dx * 1e3)
                               : fmt::format("verify, {}", c->run.label));
    run_sample(*r.scene, *c, promised.dx, true, std::numeric_limits<double>::infinity(), progress);
    if (!c->out.empty()) {
      progress.end(c->out);
      continue;
    }
    judge(*c, r.truths);
    const auto done = std::find_if(c->samples.begin(), c->samples.end(),
                                   [&](const Sample& s) { return s.verification && s.dx == promised.dx; });
    progress.end(fmt::format("error {:.3g} %, {:.3g} s; predicted {:.3g} % and {:.3g} s", 100 * *done->error,
                             done->seconds(), 100 * promised.error, promised.seconds));
    if (*done->error <= r.tolerance && !done->suspect()) {
      r.met = true;
      r.chosen = static_cast<int>(c - r.candidates.data());
      r.best = &*done;
      r.promised = promised;
    } else if (again) {
      c->out = done->suspect() ? std::string("suspect on verification")
                               : fmt::format("misses: {:.3g} % on verification", 100 * *done->error);
    } else {
      predict(*c, r.tolerance, edge, finest, r.scene->dimension);
    }
  }
}

std::string told(const Candidate& c, const Sample& s) {
  return (s.dx > 0 ? fmt::format("'{}' at dx {:.4g} mm", c.run.label, s.dx * 1e3)
                   : fmt::format("'{}'", c.run.label)) +
         fmt::format(" (error {:.3g} %, {:.3g} s)", 100 * *s.error, s.seconds());
}

/// \throws InputError where nothing can tell an error.
void check_searchable(const Scene& scene) {
  if (std::none_of(scene.probes.begin(), scene.probes.end(), decides))
    fail(scene.place,
         "--tolerance: every probe is kept to some runs or formulations; give one that all take");
  if (scene.geometry.type == "csv" && !references_suffice(scene, scene.runs.front()))
    fail(scene.place,
         "--tolerance: a cloud from a file has one spacing, so nothing but references tells errors; give "
         "every probe one that is not zero");
}

}  // namespace

double parse_tolerance(const std::string& text) {
  const bool percent = text.ends_with('%');
  const char* begin = text.data();
  const char* end = begin + text.size() - (percent ? 1 : 0);
  double value = 0;
  const auto [at, error] = std::from_chars(begin, end, value);
  if (percent) value /= 100;
  if (error != std::errc() || at != end || !(value > 0 && value < 1))
    throw InputError(fmt::format(
        "--tolerance: '{}' is no relative error greater than 0 and less than 1; valid: 1%, 0.5%, 0.01",
        text));
  return value;
}

std::string ToleranceResult::verdict() const {
  const double percent = 100 * tolerance;
  if (!best) return fmt::format("{}: no candidate ran with an error to tell.", scene->name);
  const std::string what = told(candidates[static_cast<std::size_t>(chosen)], *best);
  if (met) return fmt::format("{}: the cheapest that meets {:g} % is {}.", scene->name, percent, what);
  if (truths.spread() > tolerance)
    return fmt::format(
        "{}: nothing is shown to meet {:g} %, for the candidates' extrapolations, the only truth here, "
        "differ by "
        "{:.2g} %. Nearest: {}. Give references, or a smaller dx in [lattice].",
        scene->name, percent, 100 * truths.spread(), what);
  return fmt::format("{}: no candidate meets {:g} %; nearest: {}.", scene->name, percent, what);
}

std::vector<Row> ToleranceResult::rows(int threads) const {
  std::vector<Row> all;
  const auto add = [&](const CaseResult& result, const std::string& prefix) {
    std::vector<Row> rows = result.rows(threads);  // one a probe, then others
    SweepPoint point = result.point;
    point.erase("dx");
    for (std::size_t i = 0; i < rows.size(); ++i) {
      Row& row = rows[i];
      if (row.status == "skipped") continue;
      const auto truth =
          i < scene->probes.size() ? truths.of.find({&scene->probes[i], point}) : truths.of.end();
      if (row.status != "broke" && row.value && truth != truths.of.end() && truth->second.votes > 0) {
        row.reference = truth->second.value;
        row.error = error_of(*row.value, *row.reference, false);
      }
      row.quantity = prefix + row.quantity;
      all.push_back(std::move(row));
    }
  };
  for (const Candidate& c : candidates) {
    for (const Sample& s : c.samples)
      for (const CaseResult& result : s.cases)
        add(result, !s.verification ? "pilot_" : met && &s == best ? "chosen_" : "missed_");
    if (c.broken) add(*c.broken, "pilot_");
  }
  return all;
}

ToleranceResult search(const Scene& scene, double tolerance, bool quiet) {
  ToleranceResult r;
  r.scene = &scene;
  r.tolerance = tolerance;
  const bool from_file = scene.geometry.type == "csv";
  const bool known = references_suffice(scene, scene.runs.front());
  const double edge = from_file ? 0 : shortest_edge(scene);
  double finest = 0;
  if (from_file) {
    r.pilot_dx = {0};
  } else {
    finest = scene.lattice.dx / 8;
    const double cells = coarsest_cells(edge, scene.lattice.dx);
    r.pilot_dx = {edge / cells, edge / (2 * cells)};
    if (!known) r.pilot_dx.push_back(edge / (4 * cells));
  }
  r.candidates = candidates_of(scene, known, r.notes);
  ProgressLine progress(quiet, r.pilot_dx.size() * r.candidates.size() + 1);
  run_pilots(r, progress);
  r.truths = truths_of(scene, r.candidates);
  for (Candidate& c : r.candidates) {
    judge(c, r.truths);
    predict(c, tolerance, edge, finest, scene.dimension);
  }
  verify(r, edge, finest, progress);
  r.met = r.met && r.truths.spread() <= tolerance;
  if (!r.best) find_nearest(r);
  return r;
}

void run_tolerance(const CommonOptions& common, const std::vector<Scene>& scenes, double tolerance) {
  for (const Scene& scene : scenes) check_searchable(scene);
  const OutputFolder folder(common.out);
  const GracefulStop graceful;
  ProgressLine say(common.quiet, 1);
  std::vector<ToleranceResult> results;
  std::vector<Row> rows;
  std::string missed, interrupted;
  for (const Scene& scene : scenes) {
    try {
      results.push_back(search(scene, tolerance, common.quiet));
    } catch (const Interrupted&) {
      interrupted = fmt::format("interrupted: {} of {} scenes are done; their numbers are in {}",
                                results.size(), scenes.size(), (common.out / "results.csv").string());
      break;
    }
    const ToleranceResult& r = results.back();
    for (Row& row : r.rows(common.threads)) rows.push_back(std::move(row));
    write_results(common.out / "results.csv", rows);
    say.say(fmt::format("\n{}\n{}", plain_summary(r), r.verdict()));
    if (r.met) continue;
    if (!missed.empty()) missed += '\n';
    missed += r.verdict();
  }
  if (results.empty()) throw Interrupted(asked_to_stop(), interrupted);
  const std::vector<std::string> missing = write_tolerance_page(results, common);
  if (!gnuplot::available())
    say.say("gnuplot was not found: charts are left as tables (charts/*.csv).");
  else
    for (const std::string& what : missing) print_error("taut-compare: cannot draw " + what + '\n');
  say.say("Look at " + (common.out / "report.html").string());
  if (!interrupted.empty()) throw Interrupted(asked_to_stop(), interrupted);
  if (!missed.empty()) throw RunError(missed);
}

}  // namespace taut::bench
