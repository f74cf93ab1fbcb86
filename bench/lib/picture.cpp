#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/gnuplot.hpp>
#include <lib/picture.hpp>
#include <lib/scene_charts.hpp>
#include <lib/terminal.hpp>

namespace taut::bench {
namespace {

struct Frame {
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  void add(double x, double y) {
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
  }
};

bool finite(const std::array<double, 3>& x) {
  return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]);
}

/// Outline of the undeformed body where the geometry is simple enough to have one.
std::vector<std::array<double, 2>> outline(const ShapeSpec& shape) {
  if (shape.type == "box" && shape.min.size() >= 2)
    return {{shape.min[0], shape.min[1]},
            {shape.max[0], shape.min[1]},
            {shape.max[0], shape.max[1]},
            {shape.min[0], shape.max[1]},
            {shape.min[0], shape.min[1]}};
  return {};
}

/// Quantile of the finite values.
double quantile(std::vector<double> values, double q) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return values[static_cast<std::size_t>(at)];
}

/// "12 kPa"-like units: factor and name for a stress level.
std::pair<double, const char*> stress_unit(double level) {
  if (level >= 1e9) return {1e-9, "GPa"};
  if (level >= 1e6) return {1e-6, "MPa"};
  if (level >= 1e3) return {1e-3, "kPa"};
  return {1, "Pa"};
}

const char* field_title(const std::string& field) {
  if (field == "cauchy_xx") return "Cauchy stress xx";
  if (field == "cauchy_yy") return "Cauchy stress yy";
  if (field == "cauchy_zz") return "Cauchy stress zz";
  if (field == "cauchy_xy") return "Cauchy stress xy";
  return "von Mises stress";
}

std::string verdict(const CaseResult& c) {
  if (c.broke) return fmt::format("broke at t = {:.3g} s", c.broke_time);
  for (const Measured& m : c.measured)
    if (m.value && m.probe->type == "displacement" && m.probe->measure == "final") {
      std::string text = fmt::format("{} {:+.2f} mm", m.probe->name, *m.value * 1e3);
      if (m.reference) text += fmt::format(", truth {:+.2f}", *m.reference * 1e3);
      return text;
    }
  return "completed";
}

/// Whether all of a finished case's quantities with a truth meet the scene's accuracy.
bool within_accuracy(const CaseResult& c) {
  return std::all_of(c.measured.begin(), c.measured.end(), [&](const Measured& m) {
    const auto e = shared_error(m);
    return !e || std::abs(*e) <= c.scene->accuracy;
  });
}

/// The frame of all panels: the bodies as they should be, and a margin; what flies apart is cut off.
Frame frame_of(const std::vector<const CaseResult*>& cases) {
  Frame frame;
  bool any_whole = false;
  for (const CaseResult* c : cases) any_whole = any_whole || !c->broke;
  for (const CaseResult* c : cases) {
    for (const auto& p : outline(c->scene->geometry)) frame.add(p[0], p[1]);
    if (any_whole && c->broke) continue;
    for (const auto& x : c->snapshot->x)
      if (finite(x)) frame.add(x[0], x[1]);
  }
  const double margin = 0.06 * std::max(frame.x1 - frame.x0, frame.y1 - frame.y0);
  return {frame.x0 - margin, frame.x1 + margin, frame.y0 - margin, frame.y1 + margin};
}

using gnuplot::Literal;
using gnuplot::Script;

Script panel(const CaseResult& c, const std::string& name, const Frame& frame, double unit, int number) {
  const std::vector<double>& field = c.snapshot->fields.at(name);
  Script data;
  const double cell = c.dx > 0 ? c.dx : 0.01 * (frame.x1 - frame.x0);
  // Five digits of the frame, however far from the origin it lies.
  const double furthest =
      std::max({std::abs(frame.x0), std::abs(frame.x1), std::abs(frame.y0), std::abs(frame.y1)});
  const double extent = std::max(frame.x1 - frame.x0, frame.y1 - frame.y0);
  const int digits = 5 + std::max(0, static_cast<int>(std::log10(furthest / extent)));
  std::vector<std::pair<double, std::size_t>> depth;
  for (std::size_t i = 0; i < c.snapshot->x.size(); ++i)
    if (finite(c.snapshot->x[i]) && std::isfinite(field[i])) depth.emplace_back(c.snapshot->x[i][2], i);
  std::stable_sort(depth.begin(), depth.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (const auto& [z, i] : depth) {
    const auto& x = c.snapshot->x[i];
    if (x[0] < frame.x0 || x[0] > frame.x1 || x[1] < frame.y0 || x[1] > frame.y1) continue;
    data.add("{:.{}g} {:.{}g} {:.4g}\n", x[0] * 1e3, digits, x[1] * 1e3, digits, field[i] * unit);
  }
  if (data.empty()) data.add("NaN NaN NaN\n");
  Script lines;
  for (const auto& p : outline(c.scene->geometry)) lines.add("{} {}\n", p[0] * 1e3, p[1] * 1e3);
  if (lines.empty()) lines.add("NaN NaN\n");
  Script out("$p{} << EOD\n{}EOD\n$o{} << EOD\n{}EOD\n", number, data, number, lines);
  const char* colour = c.broke ? "#C0392B" : within_accuracy(c) ? "#1E7B45" : "#A86400";
  out.add("set label 1 {} at graph 0, 1.0 left offset 0,1.75 font ',13' textcolor rgb '#111111'\n",
          Literal(brief(c.run->label)));
  out.add("set label 2 {} at graph 0, 1.0 left offset 0,0.7 font ',12' textcolor rgb {}\n",
          Literal(verdict(c)), Literal(colour));
  // Discs a little wider than the spacing leave no gaps in a body that is whole.
  out.add(
      "plot $p{} using 1:2:({:.5g}):3 with circles lc palette fs solid 1 noborder notitle, "
      "$o{} using 1:2 with lines lc rgb '#777777' lw 1.2 dt (6,5) notitle\n",
      number, 0.72 * cell * 1e3, number);
  return out;
}

}  // namespace

bool shows(const PictureSpec& picture, const RunSpec& run) {
  return picture.runs.empty() ||
         std::find(picture.runs.begin(), picture.runs.end(), run.label) != picture.runs.end();
}

std::size_t nearest_point(const std::vector<SweepPoint>& points, const SweepPoint& wanted) {
  std::size_t best = 0;
  double best_distance = 1e300;
  for (std::size_t i = 0; i < points.size(); ++i) {
    double distance = 0;
    for (const auto& [name, value] : wanted) {
      const auto found = points[i].find(name);
      if (found == points[i].end()) continue;
      const double scale = std::abs(value) + std::abs(found->second);
      if (scale > 0) distance += std::abs(found->second - value) / scale;
    }
    if (distance < best_distance) {
      best_distance = distance;
      best = i;
    }
  }
  return best;
}

bool write_picture(const PictureSpec& picture, const std::vector<const CaseResult*>& cases,
                   const std::filesystem::path& image, std::string& why) {
  const Frame frame = frame_of(cases);
  std::vector<double> sound;
  const bool any_whole =
      std::any_of(cases.begin(), cases.end(), [](const CaseResult* c) { return !c->broke; });
  for (const CaseResult* c : cases)
    if (!any_whole || !c->broke) {
      const std::vector<double>& field = c->snapshot->fields.at(picture.field);
      sound.insert(sound.end(), field.begin(), field.end());
    }
  double low = quantile(sound, 0.02), high = quantile(sound, 0.98);
  const auto [unit, unit_name] = stress_unit(std::max(std::abs(low), std::abs(high)));
  // Zero belongs to the scale, so that a stress can be told from none.
  low = std::min(low, 0.0);
  high = std::max(high, 0.0);
  low *= unit;
  high *= unit;
  if (!(high > low)) high = low + 1;

  const int columns = cases.size() > 1 ? 2 : 1;
  const int rows = (static_cast<int>(cases.size()) + columns - 1) / columns;
  const double width = 1240, panel_width = (width - 150) / columns - 60;
  const double panel_height =
      std::clamp(panel_width * (frame.y1 - frame.y0) / (frame.x1 - frame.x0), 60.0, 620.0);
  const double pitch = panel_height + 110, head = 60, height = head + rows * pitch + 10;

  Script script(
      "set encoding utf8\nset border 3 lc rgb '#888888'\nset tics nomirror textcolor rgb '#444444' font "
      "',10'\n"
      "set size ratio -1\nset palette defined (0 '#352a87', 1 '#0f5cdd', 2 '#1481d6', 3 '#06a4ca', 4 "
      "'#2eb7a4', "
      "5 '#87bf77', 6 '#d1bb59', 7 '#fec832', 8 '#f9fb0e')\n");
  script.add("set xrange [{}:{}]\nset yrange [{}:{}]\nset cbrange [{}:{}]\n", frame.x0 * 1e3, frame.x1 * 1e3,
             frame.y0 * 1e3, frame.y1 * 1e3, low, high);
  script.add("set cblabel {} font ',12' offset 1.2,0\n",
             Literal(fmt::format("{} [{}]", field_title(picture.field), unit_name)));
  script.add("unset colorbox\nset multiplot\n");
  script.add("set label 10 {} at screen {}, screen {} left font ',17' textcolor rgb '#111111'\n",
             Literal(picture.title +
                     (describe(cases[0]->point).empty() ? "" : "  (" + describe(cases[0]->point) + ")")),
             50 / width, 1 - 28 / height);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const int row = static_cast<int>(i) / columns, column = static_cast<int>(i) % columns;
    const double left = 50 + column * (panel_width + 60), bottom = height - head - (row + 1) * pitch + 50;
    script.add(
        "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen "
        "{}\n",
        left / width, (left + panel_width) / width, bottom / height, (bottom + panel_height) / height);
    const bool last = i + 1 == cases.size();
    if (row + 1 == rows || i + static_cast<std::size_t>(columns) >= cases.size())
      script.add("set xlabel 'x [mm]' font ',11' offset 0,0.4\n");
    else
      script.add("unset xlabel\n");
    if (column == 0)
      script.add("set ylabel 'y [mm]' font ',11' offset 1,0\n");
    else
      script.add("unset ylabel\n");
    if (last)
      script.add("set colorbox user origin screen {}, screen {} size screen {}, screen {}\n", 1 - 100 / width,
                 (height - head - rows * pitch + 50) / height, 16 / width, (rows * pitch - 110) / height);
    script.add("{}unset label 10\n", panel(*cases[i], picture.field, frame, unit, static_cast<int>(i)));
  }
  script.add("unset multiplot\n");
  const Script terminal("pngcairo size {:.0f},{:.0f} font 'DejaVu Sans,11' noenhanced background '#ffffff'",
                        width, height);
  return gnuplot::draw(terminal, script, image, why);
}

}  // namespace taut::bench
