#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/gnuplot.hpp>
#include <lib/picture.hpp>
#include <lib/scene_charts.hpp>
#include <lib/terminal.hpp>
#include <lib/view.hpp>

namespace taut::bench {
namespace {

struct Frame {
  double x0 = 1e300, x1 = -1e300, y0 = 1e300, y1 = -1e300;
  bool empty() const { return x1 < x0; }
  double width() const { return x1 - x0; }
  double height() const { return y1 - y0; }
  double extent() const { return std::max(width(), height()); }
  bool contains(double x, double y) const { return x >= x0 && x <= x1 && y >= y0 && y <= y1; }
  void add(double x, double y) {
    x0 = std::min(x0, x);
    x1 = std::max(x1, x);
    y0 = std::min(y0, y);
    y1 = std::max(y1, y);
  }
};

bool finite(const Point& x) { return std::isfinite(x[0]) && std::isfinite(x[1]) && std::isfinite(x[2]); }

/// Outline of the undeformed body where the geometry is simple enough to have one: its edges.
std::vector<std::array<Point, 2>> outline(const ShapeSpec& shape) {
  std::vector<std::array<Point, 2>> edges;
  const std::size_t dimension = shape.min.size();
  if (shape.type != "box" || dimension < 2) return edges;
  const auto corner = [&](unsigned which) {
    Point x{};
    for (std::size_t d = 0; d < dimension; ++d) x[d] = which >> d & 1 ? shape.max[d] : shape.min[d];
    return x;
  };
  for (unsigned from = 0; from < 1U << dimension; ++from)
    for (std::size_t d = 0; d < dimension; ++d)
      if (!(from >> d & 1)) edges.push_back({corner(from), corner(from | 1U << d)});
  return edges;
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

/// The frame of all panels: the bodies as they should be, and those that broke as far as they lie within
/// another such frame around it; few are farther away than that.
Frame frame_of(const std::vector<const CaseResult*>& cases, const View& view) {
  Frame frame;
  for (const CaseResult* c : cases) {
    for (const auto& edge : outline(c->scene->geometry))
      for (const Point& x : edge) frame.add(view.project(x)[0], view.project(x)[1]);
    if (c->broke) continue;
    for (const Point& x : c->snapshot->x)
      if (finite(x)) frame.add(view.project(x)[0], view.project(x)[1]);
  }
  if (frame.empty()) {  // nothing but bodies that broke: where most of their particles are
    std::vector<double> u, v;
    for (const CaseResult* c : cases)
      for (const Point& x : c->snapshot->x) {
        u.push_back(view.project(x)[0]);
        v.push_back(view.project(x)[1]);
      }
    frame = {quantile(u, 0.05), quantile(u, 0.95), quantile(v, 0.05), quantile(v, 0.95)};
  }
  const double reach = frame.extent();
  const Frame limit{frame.x0 - reach, frame.x1 + reach, frame.y0 - reach, frame.y1 + reach};
  for (const CaseResult* c : cases)
    for (const Point& x : c->snapshot->x)
      if (const Point p = view.project(x); c->broke && finite(x) && limit.contains(p[0], p[1]))
        frame.add(p[0], p[1]);
  const double margin = frame.extent() > 0 ? 0.06 * frame.extent() : 1;
  // Below a view from a corner lie the axes and the scale.
  const double foot = view.is_straight() ? 0 : 0.16 * frame.extent();
  return {frame.x0 - margin, frame.x1 + margin, frame.y0 - margin - foot, frame.y1 + margin};
}

using gnuplot::Literal;
using gnuplot::Script;

/// The colours of the scale, from its lower to its upper end.
constexpr std::array<std::array<int, 3>, 9> palette = {{{0x35, 0x2a, 0x87},
                                                        {0x0f, 0x5c, 0xdd},
                                                        {0x14, 0x81, 0xd6},
                                                        {0x06, 0xa4, 0xca},
                                                        {0x2e, 0xb7, 0xa4},
                                                        {0x87, 0xbf, 0x77},
                                                        {0xd1, 0xbb, 0x59},
                                                        {0xfe, 0xc8, 0x32},
                                                        {0xf9, 0xfb, 0x0e}}};

Script palette_script() {
  Script stops;
  for (std::size_t i = 0; i < palette.size(); ++i)
    stops.add("{}{} {}", stops.empty() ? Script("") : Script(", "), static_cast<int>(i),
              Literal(fmt::format("#{:02x}{:02x}{:02x}", palette[i][0], palette[i][1], palette[i][2])));
  return Script("set palette defined ({})\n", stops);
}

/// A colour of the scale as 0xrrggbb, darker in the shade.
int shaded(double share, double brightness) {
  const double at = std::clamp(share, 0.0, 1.0) * (palette.size() - 1);
  const auto low = std::min(static_cast<std::size_t>(at), palette.size() - 2);
  const double t = at - static_cast<double>(low);
  int colour = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    const double value = (1 - t) * palette[low][c] + t * palette[low + 1][c];
    colour = colour << 8 | static_cast<int>(std::lround(std::clamp(value * brightness, 0.0, 255.0)));
  }
  return colour;
}

/// What all panels share.
struct Look {
  View view;
  Frame frame;
  std::string field;
  double unit = 1, low = 0, high = 1;  // of the field: factor, ends of the scale
  bool lit = false;
  std::size_t longest_label = 62;  // characters
};

/// The largest of 1, 2, 5 times a power of ten up to `most`.
double round_length(double most) {
  const double decade = std::pow(10, std::floor(std::log10(most)));
  return decade * (most >= 5 * decade ? 5 : most >= 2 * decade ? 2 : 1);
}

/// Where the axes point and how long something is, where there are no axes to read it from.
Script directions(const Look& look) {
  const Frame& f = look.frame;
  const double length = 0.09 * f.extent(), foot = 0.085 * f.extent();
  Point from{f.x0 + 0.1 * f.extent(), f.y0 + foot, 0};
  Script out;
  for (std::size_t d = 0; d < 3; ++d) {
    Point axis{};
    axis[d] = length;
    const Point to = look.view.project(axis);
    out.add("set arrow from first {:.5g},{:.5g} to first {:.5g},{:.5g} lc rgb '#444444' lw 1.4 front\n",
            from[0] * 1e3, from[1] * 1e3, (from[0] + to[0]) * 1e3, (from[1] + to[1]) * 1e3);
    out.add("set label {} {} at first {:.5g},{:.5g} center font ',11' textcolor rgb '#444444'\n", 20 + d,
            Literal(std::string(1, static_cast<char>('x' + d))), (from[0] + 1.3 * to[0]) * 1e3,
            (from[1] + 1.3 * to[1]) * 1e3);
  }
  const double bar = round_length(0.25 * f.extent());
  const double right = f.x1 - 0.04 * f.extent(), level = f.y0 + 0.4 * foot;
  out.add(
      "set arrow from first {:.5g},{:.5g} to first {:.5g},{:.5g} heads size screen 0.004,90 lc rgb '#444444' "
      "lw 1.4\n",
      (right - bar) * 1e3, level * 1e3, right * 1e3, level * 1e3);
  out.add("set label 30 {} at first {:.5g},{:.5g} center offset 0,0.7 font ',11' textcolor rgb '#444444'\n",
          Literal(fmt::format("{:g} mm", bar * 1e3)), (right - bar / 2) * 1e3, level * 1e3);
  return out;
}

Script panel(const CaseResult& c, const Look& look, int number) {
  const Snapshot& shot = *c.snapshot;
  const std::vector<double>& field = shot.fields.at(look.field);
  const Frame& frame = look.frame;
  // Five digits of the frame, however far from the origin it lies.
  const double furthest =
      std::max({std::abs(frame.x0), std::abs(frame.x1), std::abs(frame.y0), std::abs(frame.y1)});
  const int digits = 5 + std::max(0, static_cast<int>(std::log10(furthest / frame.extent())));
  std::vector<std::pair<Point, std::size_t>> order;
  int outside = 0;
  for (std::size_t i = 0; i < shot.x.size(); ++i) {
    const Point p = look.view.project(shot.x[i]);
    if (!finite(shot.x[i]) || !frame.contains(p[0], p[1]))
      ++outside;
    else if (std::isfinite(field[i]))
      order.emplace_back(p, i);
  }
  // What is nearer is drawn later.
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first[2] < b.first[2]; });
  const std::vector<Point> normals = look.lit ? outward(shot.x, shot.spacing) : std::vector<Point>{};
  Script data;
  for (const auto& [p, i] : order) {
    data.add("{:.{}g} {:.{}g} ", p[0] * 1e3, digits, p[1] * 1e3, digits);
    const double value = field[i] * look.unit;
    if (look.lit)
      data.add("{}\n", shaded((value - look.low) / (look.high - look.low), look.view.brightness(normals[i])));
    else
      data.add("{:.4g}\n", value);
  }
  if (data.empty()) data.add("NaN NaN NaN\n");
  Script lines;
  for (const auto& edge : outline(c.scene->geometry)) {
    for (const Point& x : edge)
      lines.add("{} {}\n", look.view.project(x)[0] * 1e3, look.view.project(x)[1] * 1e3);
    lines.add("\n");
  }
  if (lines.empty()) lines.add("NaN NaN\n");
  Script out("$p{} << EOD\n{}EOD\n$o{} << EOD\n{}EOD\n", number, data, number, lines);
  const char* colour = c.broke ? "#C0392B" : within_accuracy(c) ? "#1E7B45" : "#A86400";
  out.add("set label 1 {} at graph 0, 1.0 left offset 0,1.75 font ',13' textcolor rgb '#111111'\n",
          Literal(shortened(c.run->label, look.longest_label)));
  const std::string beyond = outside ? fmt::format("; {} particles lie outside of the picture", outside) : "";
  out.add("set label 2 {} at graph 0, 1.0 left offset 0,0.7 font ',12' textcolor rgb {}\n",
          Literal(verdict(c) + beyond), Literal(colour));
  // Discs a little wider than the spacing leave no gaps in a body that is whole.
  const double disc = 0.72e3 * (shot.spacing > 0 ? shot.spacing : 0.01 * frame.width());
  const Script colours(look.lit
                           ? Script("1:2:({:.5g}):3 with circles lc rgb variable fs solid 1 noborder", disc)
                           : Script("1:2:({:.5g}):3 with circles lc palette fs solid 1 noborder", disc));
  // The last one is not seen; it lets the scale of colours be drawn.
  out.add(
      "plot $p{} using {} notitle, "
      "$o{} using 1:2 with lines lc rgb '#777777' lw 1.2 dt (6,5) notitle, "
      "$p{} using (NaN):(NaN):({}) with points palette notitle\n",
      number, colours, number, number, look.low);
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

bool write_picture(const PictureSpec& picture, const std::vector<const CaseResult*>& all,
                   const std::filesystem::path& image, std::string& why) {
  constexpr std::size_t most_panels = 24;
  const std::vector<const CaseResult*> cases(all.begin(), all.begin() + std::min(all.size(), most_panels));
  Look look{View(picture.from), {}, picture.field, 1, 0, 1, false};
  // Along an axis there is one face to see, and colours are those of the scale.
  look.lit = cases[0]->scene->dimension == 3 && !look.view.is_straight();
  const Frame frame = look.frame = frame_of(cases, look.view);
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
  look.unit = unit;
  look.low = low;
  look.high = high;

  const int columns = cases.size() > 8 ? 3 : cases.size() > 1 ? 2 : 1;
  if (columns > 2) look.longest_label = 34;
  const int rows = (static_cast<int>(cases.size()) + columns - 1) / columns;
  const double width = 1240, panel_width = (width - 150) / columns - 60;
  const double panel_height =
      std::clamp(panel_width * (frame.y1 - frame.y0) / (frame.x1 - frame.x0), 60.0, 620.0);
  const double pitch = panel_height + 110, head = 60, height = head + rows * pitch + 10;

  Script script(
      "set encoding utf8\nset border 3 lc rgb '#888888'\nset tics nomirror textcolor rgb '#444444' font "
      "',10'\n"
      "set size ratio -1\n");
  script.add("{}", palette_script());
  // Three numbers along the height of a panel, which is often low, and six along its width.
  script.add("set xtics {}\nset ytics {}\n", 1e3 * round_length(frame.width() / (columns > 2 ? 3 : 5)),
             1e3 * round_length(frame.height() / 2.5));
  if (!look.view.is_straight()) script.add("unset border\nunset xtics\nunset ytics\n{}", directions(look));
  script.add("set xrange [{}:{}]\nset yrange [{}:{}]\nset cbrange [{}:{}]\n", frame.x0 * 1e3, frame.x1 * 1e3,
             frame.y0 * 1e3, frame.y1 * 1e3, low, high);
  script.add("set cblabel {} font ',12' offset 1.2,0\n",
             Literal(fmt::format("{} [{}]", field_title(picture.field), unit_name)));
  script.add("unset colorbox\nset multiplot\n");
  script.add(
      "set label 10 {} at screen {}, screen {} left font ',17' textcolor rgb '#111111'\n",
      Literal(picture.title +
              (describe(cases[0]->point).empty() ? "" : "  (" + describe(cases[0]->point) + ")") +
              (cases.size() < all.size() ? fmt::format(", the first {} of {} runs", cases.size(), all.size())
                                         : "")),
      50 / width, 1 - 28 / height);
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const int row = static_cast<int>(i) / columns, column = static_cast<int>(i) % columns;
    const double left = 50 + column * (panel_width + 60), bottom = height - head - (row + 1) * pitch + 50;
    script.add(
        "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen "
        "{}\n",
        left / width, (left + panel_width) / width, bottom / height, (bottom + panel_height) / height);
    const bool last = i + 1 == cases.size();
    const auto axis = [](int number) {
      return Literal(std::string(1, static_cast<char>('x' + number)) + " [mm]");
    };
    const bool lowest = row + 1 == rows || i + static_cast<std::size_t>(columns) >= cases.size();
    if (lowest && look.view.is_straight())
      script.add("set xlabel {} font ',11' offset 0,0.4\n", axis(look.view.right_axis()));
    else
      script.add("unset xlabel\n");
    if (column == 0 && look.view.is_straight())
      script.add("set ylabel {} font ',11' offset 1,0\n", axis(look.view.up_axis()));
    else
      script.add("unset ylabel\n");
    const double bar = std::min(rows * pitch - 110, 900.0);
    if (last)
      script.add("set colorbox user origin screen {}, screen {} size screen {}, screen {}\n", 1 - 100 / width,
                 (height - head - 60 - bar) / height, 16 / width, bar / height);
    script.add("{}unset label 10\n", panel(*cases[i], look, static_cast<int>(i)));
  }
  script.add("unset multiplot\n");
  const Script terminal("pngcairo size {:.0f},{:.0f} font 'DejaVu Sans,11' noenhanced background '#ffffff'",
                        width, height);
  return gnuplot::draw(terminal, script, image, why);
}

}  // namespace taut::bench
