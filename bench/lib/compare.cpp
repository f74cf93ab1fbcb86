#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <lib/case.hpp>
#include <lib/compare.hpp>
#include <lib/estimate.hpp>
#include <lib/files.hpp>
#include <lib/gnuplot.hpp>
#include <lib/picture.hpp>
#include <lib/progress.hpp>
#include <lib/reference.hpp>
#include <lib/report.hpp>
#include <lib/scene_loader.hpp>
#include <lib/signals.hpp>
#include <lib/terminal.hpp>
#include <lib/text_table.hpp>
#include <lib/tolerance.hpp>
#include <map>
#include <set>
#include <tuple>

namespace taut::bench {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Two cases of the same name would overwrite each other's files.
void check_names(const Scene& scene) {
  std::map<std::string, const RunSpec*> taken;
  for (const RunSpec& run : scene.runs)
    for (const SweepPoint& point : scene.points()) {
      if (!wanted(run, point)) continue;
      const std::string name = case_name(scene, run, point);
      const auto [found, added] = taken.insert({name, &run});
      if (!added)
        fail(run.place,
             fmt::format("[run] label: the files of '{}' and of '{}' ({}) would both be named '{}'; give it "
                         "another label",
                         brief(run.label), brief(found->second->label), found->second->place.str(), name));
    }
}

/// Everything that can be wrong with a scene comes to light here, before the first run and the first file.
void check_scene(const Scene& scene, double limit) {
  check_names(scene);
  std::set<std::tuple<const RunSpec*, double, double, bool>> checked;
  for (const RunSpec& run : scene.runs)
    for (const SweepPoint& point : scene.points()) {
      if (!wanted(run, point)) continue;
      for (const ProbeSpec& probe : scene.probes)
        if (wanted(probe, run, point)) {
          reference_value(scene, run, point, probe);
          for (const PrintedSpec& printed : probe.printed) printed_value(probe, printed, point);
        }
      // Loads change neither particles nor operators: one check for all of them, but for whether there are
      // any.
      const auto load = point.find("load");
      const bool unloaded = load != point.end() && load->second == 0;
      const MaterialSpec material = material_of(scene, run, point);
      check_size(scene, run, point, limit);
      if (checked.insert({&run, lattice_of(run, point).dx, material.parameters.nu, unloaded}).second)
        check_case(scene, run, point);
    }
}

std::string outcome(const CaseResult& result) {
  if (result.broke)
    return fmt::format("BROKE at t = {:.4g} s, step {}: {}{}{}", result.broke_time, result.steps, result.what,
                       result.where.empty() ? "" : "; ", result.where);
  std::string text;
  for (const Measured& m : result.measured) {
    if (!m.why_none.empty())
      text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", m.probe->name, m.why_none);
    if (!m.value) continue;
    text +=
        fmt::format("{}{} = {:.5g} {}", text.empty() ? "" : ", ", m.probe->name, *m.value, m.probe->unit());
    if (m.reference && *m.reference != 0)
      text += " (" + signed_percent(error_of(*m.value, *m.reference, false), 2) + ')';
  }
  const std::string warning = result.suspect() ? "; SUSPECT: " + result.health.complaints() : "";
  return fmt::format("{}; {} steps, {:.2f} s, {:.2f} M particle-steps/s{}", text.empty() ? "done" : text,
                     result.steps, result.loop_s, result.rate() * 1e-6, warning);
}

void write_histories(const CaseResult& result, const std::filesystem::path& file) {
  if (result.measured.empty() || result.measured[0].history.t.empty()) return;
  std::string text = "time";
  for (const Measured& m : result.measured) {
    text += ',' + m.probe->name;
    if (!m.exact.t.empty()) text += ',' + m.probe->name + "_exact";
  }
  text += '\n';
  for (std::size_t i = 0; i < result.measured[0].history.t.size(); ++i) {
    text += fmt::format("{}", result.measured[0].history.t[i]);
    for (const Measured& m : result.measured) {
      text += fmt::format(",{}", m.history.value[i]);
      if (!m.exact.t.empty()) text += fmt::format(",{}", m.exact.value[i]);
    }
    text += '\n';
  }
  write_file(file, text);
}

bool in_a_picture(const Scene& scene, const RunSpec& run, std::size_t point) {
  return std::any_of(scene.pictures.begin(), scene.pictures.end(), [&](const PictureSpec& picture) {
    return shows(picture, run) && nearest_point(scene.points(), picture.of) == point;
  });
}

}  // namespace

void run_compare(const CommonOptions& common, const CompareOptions& options) {
  const auto start = Clock::now();
  std::vector<Scene> scenes;
  for (const std::string& file : options.scenes) scenes.push_back(load_scene(file, common.quick));
  std::set<std::string> scene_names;
  for (const Scene& scene : scenes)
    if (!scene_names.insert(scene.name).second)
      fail(scene.place, "[scene] name: another scene of this job is called so: " + scene.name);
  const double limit = options.max_memory > 0 ? options.max_memory : memory_limit();
  if (options.dry_run) {
    for (const Scene& scene : scenes) print_out(plain(dry_run(scene, common.threads, limit)) + '\n');
    return;
  }
  for (const Scene& scene : scenes) check_scene(scene, limit);
  if (options.tolerance) return run_tolerance(common, scenes, *options.tolerance);

  std::size_t total = 0;
  for (const Scene& scene : scenes)
    for (const RunSpec& run : scene.runs)
      for (const SweepPoint& point : scene.points()) total += wanted(run, point);
  const OutputFolder folder(common.out);
  const GracefulStop graceful;
  ProgressLine progress(common.quiet, total);
  if (!options.no_fields) {
    if (has_field_output())
      make_folder(common.out / "fields");
    else
      progress.say("This build has no HDF5: fields are left out.");
  }

  std::vector<Row> rows;
  Report report{"taut-compare", common.threads, common.quick, 0, {}};
  std::size_t item = 0, done = 0;
  std::string field_error;
  const auto run_one = [&](const Scene& scene, const RunSpec& run, const SweepPoint& point, std::size_t p) {
    const std::string name = case_name(scene, run, point);
    const std::string where = describe(point);
    progress.begin(item++,
                   fmt::format("{}, {}{}{}", scene.name, run.label, where.empty() ? "" : ", ", where));
    bool stopped = false;
    CaseOptions how;
    if (!options.no_fields && has_field_output()) how.field_file = common.out / "fields" / (name + ".vtkhdf");
    how.keep_snapshot = in_a_picture(scene, run, p);
    how.progress = [&](std::int64_t steps, double, double fraction) {
      progress.update(steps, fraction);
      stopped = asked_to_stop() != 0;
      return !stopped;
    };
    // What was computed is on the disk before anyone is told of it, and before what may fail is tried.
    how.measured = [&](const CaseResult& result) {
      if (stopped) throw Interrupted(asked_to_stop(), "");
      for (Row& row : result.rows(common.threads)) rows.push_back(std::move(row));
      write_results(common.out / "results.csv", rows);
      write_histories(result, common.out / "histories" / (name + ".csv"));
      progress.end(outcome(result));
    };
    try {
      report.scenes.back().cases.push_back(run_case(scene, run, point, how));
    } catch (const InputError& error) {
      // What only a run finds: files are there already, so that this is no bad input of which nothing came.
      throw RunError(fmt::format("{}: [run] '{}': {}", run.place.str(), run.label, error.what()));
    }
    ++done;
    field_error = report.scenes.back().cases.back().field_error;
  };
  const auto go_on = [&] { return !asked_to_stop() && field_error.empty(); };
  try {
    for (const Scene& scene : scenes) {
      report.scenes.push_back({&scene, {}});
      const std::vector<SweepPoint> points = scene.points();
      for (const RunSpec& run : scene.runs)
        for (std::size_t p = 0; p < points.size() && go_on(); ++p)
          if (wanted(run, points[p])) run_one(scene, run, points[p], p);
    }
  } catch (const Interrupted&) {  // in the middle of a case: what there is follows
  }
  report.wall_s = seconds_since(start);
  if (done < total) report.unfinished = total - done;
  std::vector<std::string> missing;
  try {
    missing = write_report(report, common.out);
  } catch (const RunError&) {
    if (field_error.empty()) throw;  // else the first thing that failed is what to tell
  }
  if (!gnuplot::available()) {
    progress.say("gnuplot was not found: charts are left as tables (charts/*.csv), pictures are left out.");
  } else {
    for (const std::string& what : missing) print_error("taut-compare: cannot draw " + what + '\n');
  }
  const std::string page = (common.out / "report.html").string();
  if (!field_error.empty()) throw RunError(field_error);
  if (done < total)
    throw Interrupted(asked_to_stop(),
                      fmt::format("interrupted: {} of {} cases are done, and in {}", done, total, page));
  progress.say(fmt::format("{} cases in {:.1f} s. Look at {}", total, report.wall_s, page));
}

}  // namespace taut::bench
