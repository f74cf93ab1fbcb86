#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <lib/chart.hpp>
#include <lib/files.hpp>
#include <lib/gnuplot.hpp>
#include <lib/terminal.hpp>
#include <limits>
#include <map>

namespace taut::bench {
namespace {

constexpr int chart_width = 860, plot_height = 440;

struct Extent {
  double min = std::numeric_limits<double>::max(), max = -std::numeric_limits<double>::max();
  void add(double v, bool log) {
    if (!std::isfinite(v) || (log && v <= 0)) return;
    min = std::min(min, v);
    max = std::max(max, v);
  }
  bool empty() const { return max < min; }
};

/// A little room on both sides; whole decades' fractions on logarithmic axes.
Extent padded_extent(Extent e, bool log, double below, double above) {
  if (e.empty()) return log ? Extent{0.1, 10} : Extent{-1, 1};
  if (log) {
    const double ratio = std::max(e.max / e.min, 4.0);
    return {e.min / std::pow(ratio, below), e.max * std::pow(ratio, above)};
  }
  const double span = e.max > e.min ? e.max - e.min : e.max != 0 ? std::abs(e.max) : 1;
  return {e.min - below * span, e.max + above * span};
}

std::string csv_of(const Chart& chart) {
  std::string text = "series,x,y\n";
  for (const Series& s : chart.series) {
    std::string label = s.label;
    std::replace(label.begin(), label.end(), ',', ';');
    for (std::size_t i = 0; i < s.x.size(); ++i) text += fmt::format("{},{},{}\n", label, s.x[i], s.y[i]);
    for (const double x : s.broke_x) text += fmt::format("{},{},broke\n", label, x);
  }
  return text;
}

using gnuplot::Literal;
using gnuplot::Script;

/// One more than there are marks, so that colour and mark together tell 56 runs apart.
constexpr int colours = 8;

Script style_of(const Series& s) {
  static constexpr std::array<int, 7> filled = {7, 5, 9, 13, 11, 15, 7}, hollow = {6, 4, 8, 12, 10, 14, 6};
  const Literal colour(run_colour(s.colour));
  const auto mark = static_cast<std::size_t>(s.mark < 0 ? std::max(s.colour, 0) : s.mark) % filled.size();
  switch (s.style) {
    case Series::Style::truth:
      return s.marks ? Script("with linespoints lc rgb '#111111' lw 2 pt 1 ps 0.9")
                     : Script("with lines lc rgb '#111111' lw 2");
    case Series::Style::guide:
      return Script("with lines lc rgb '#999999' lw 1 dt 2");
    case Series::Style::printed:
      return Script("with points lc rgb {} lw 1.6 pt {} ps 1.15", colour, hollow[mark]);
    case Series::Style::bar:
      return Script("with boxes fill solid 1 noborder lc rgb {}", colour);
    case Series::Style::scatter:
      return Script("with points lc rgb {} pt {} ps 1", colour, filled[mark]);
    case Series::Style::run:
      break;
  }
  // Lines without marks go on in other dashes where colours begin again.
  if (!s.marks)
    return Script("with lines lc rgb {} lw 1.8 dt {}", colour, 1 + std::max(s.colour, 0) / colours % 5);
  return Script("with linespoints lc rgb {} lw 1.8 pt {} ps 0.75", colour, filled[mark]);
}

void add_tick(Script& ticks, const std::string& text, double at) {
  if (!ticks.empty()) ticks.add(", ");
  ticks.add("{} {}", Literal(text), at);
}

/// Ticks at 1, 2 and 5 of each decade, or at decades alone where there are many.
Script log_ticks(const Extent& e) {
  Script ticks;
  const bool many = e.max / e.min > 1e3;
  for (int decade = static_cast<int>(std::floor(std::log10(e.min))); std::pow(10, decade) <= e.max; ++decade)
    for (const int digit : {1, 2, 5}) {
      const double at = digit * std::pow(10, decade);
      if (at < e.min || at > e.max || (many && digit != 1)) continue;
      add_tick(ticks, fmt::format("{:g}", at), at);
    }
  return Script("({})", ticks);
}

Script given_ticks(const std::vector<double>& values) {
  Script ticks;
  for (const double value : values) add_tick(ticks, fmt::format("{:g}", value), value);
  return Script("({})", ticks);
}

Script named_ticks(const std::vector<std::string>& names) {
  Script ticks;
  for (std::size_t i = 0; i < names.size(); ++i) add_tick(ticks, names[i], static_cast<double>(i));
  return Script("({})", ticks);
}

/// The legend below a chart: lower than the plot. Long labels are cut where that makes room for more of them,
/// and what has no room is counted.
struct Legend {
  int rows = 0, shown = 0, more = 0;
  std::size_t longest = 90;  // characters of an entry
  std::size_t widest = 0;

  explicit Legend(const Chart& chart) {
    constexpr int most_rows = 12;
    int entries = 0;
    for (const Series& s : chart.series) {
      if (s.label.empty() || !s.in_legend) continue;
      widest = std::max(widest, characters(shortened(s.label, longest)));
      ++entries;
    }
    const auto columns_of = [](std::size_t wide) {
      return std::clamp((chart_width - 90) / (8 * static_cast<int>(wide) + 60), 1, 4);
    };
    int columns = entries < 4 ? 1 : columns_of(widest);
    if (entries > most_rows * columns && columns == 1) {
      widest = longest = 40;
      columns = columns_of(longest);
    }
    rows = (entries + columns - 1) / columns;
    shown = entries;
    if (rows <= most_rows) return;
    rows = most_rows;
    shown = rows * columns - 1;
    more = entries - shown;
  }
};

/// Both axes' ranges, in which runs that broke have a say, but no more.
Extent range_of_values(const Chart& chart) {
  Extent sound, all;
  for (const Series& s : chart.series)
    for (const double v : s.y) {
      all.add(v, chart.log_y);
      if (!s.wild) sound.add(v, chart.log_y);
    }
  if (sound.empty() || all.empty()) return all;
  if (chart.log_y) return {std::max(all.min, sound.min / 100), std::min(all.max, sound.max * 100)};
  const double span =
      std::max(sound.max - sound.min, 1e-3 * std::max(std::abs(sound.max), std::abs(sound.min)));
  return {std::max(all.min, sound.min - span), std::min(all.max, sound.max + span)};
}

Script script_of(const Chart& chart) {
  Extent x, y = range_of_values(chart);
  int broken = 0;
  for (const Series& s : chart.series) {
    for (const double v : s.x) x.add(v, chart.log_x);
    for (const double v : s.broke_x) x.add(v, chart.log_x);
    broken += !s.broke_x.empty();
  }
  if (chart.line_at_zero) y.add(0, chart.log_y);
  x = chart.x_names.empty() ? padded_extent(x, chart.log_x, 0.04, 0.04)
                            : Extent{-0.6, static_cast<double>(chart.x_names.size()) - 0.4};
  // Rows for the crosses of runs that broke, below everything else.
  const double crosses_step = broken > 6 ? 0.3 / broken : 0.05;
  const double room = 1.1 * crosses_step * broken + (broken ? 0.09 : 0);
  y = padded_extent(y, chart.log_y, 0.06 + room, 0.07);

  Script out("set title {} font ',15'\nset xlabel {}\nset ylabel {}\n", Literal(chart.title),
             Literal(chart.x_label), Literal(chart.y_label));
  out.add(
      "set border 3 lc rgb '#555555'\nset tics nomirror textcolor rgb '#333333'\nset grid lc rgb '#e4e4e4' "
      "lw 1 lt 1\n"
      "set key below left vertical samplen 2.5 spacing 1.15 Left reverse noenhanced\n");
  const Legend legend(chart);
  // Characters are narrower than gnuplot takes them for.
  out.add("set key maxrows {} width {}\n", legend.rows, 1 - 0.2 * static_cast<double>(legend.widest));
  if (chart.log_x)
    out.add("set logscale x\nset xtics {}\n",
            chart.x_ticks.empty() ? log_ticks(x) : given_ticks(chart.x_ticks));
  const auto bars = std::count_if(chart.series.begin(), chart.series.end(),
                                  [](const Series& s) { return s.style == Series::Style::bar; });
  const double bar_width = 0.8 / static_cast<double>(std::max<std::ptrdiff_t>(bars, 1));
  if (!chart.x_names.empty())
    out.add("set xtics {}\nset boxwidth {}\n", named_ticks(chart.x_names), 0.9 * bar_width);
  if (bars && !chart.log_y) y.min = 0;
  if (chart.log_y) out.add("set logscale y\nset ytics {}\n", log_ticks(y));
  if (!chart.log_x && std::max(std::abs(x.min), std::abs(x.max)) < 1e-2) out.add("set format x '%.1s %c'\n");
  out.add("set xrange [{}:{}]\nset yrange [{}:{}]\n", x.min, x.max, y.min, y.max);
  if (chart.line_at_zero && !chart.log_y)
    out.add("set arrow from graph 0, first 0 to graph 1, first 0 nohead lc rgb '#777777' lw 1 back\n");
  if (broken)
    out.add("set label 'broke:' at graph 0.01, graph {} font ',11' textcolor rgb '#666666'\n",
            0.05 + crosses_step * broken);

  double up = 0.45;  // above and below by turns: neighbours are less in each other's way
  for (const ChartLabel& label : chart.labels) {
    out.add("set label {} at {},{} left offset 0.8,{} font ',11' textcolor rgb '#333333' front\n",
            Literal(label.text), label.x, label.y, up);
    up = -up;
  }

  Script plots;
  int row = 0, block = 0, bar = 0, entries = 0;
  const auto add = [&](const Script& what) {
    plots.add("{}{}", plots.empty() ? Script("plot ") : Script(", \\\n     "), what);
  };
  for (const Series& s : chart.series) {
    Script data;
    const double beside =
        s.style == Series::Style::bar ? (bar++ - 0.5 * static_cast<double>(bars - 1)) * bar_width : 0;
    for (std::size_t i = 0; i < s.x.size(); ++i)
      if (std::isfinite(s.x[i]) && std::isfinite(s.y[i])) data.add("{} {}\n", s.x[i] + beside, s.y[i]);
    if (data.empty()) data.add("NaN NaN\n");
    const bool listed = !s.label.empty() && s.in_legend && entries++ < legend.shown;
    const Script title =
        listed ? Script("title {}", Literal(shortened(s.label, legend.longest))) : Script("notitle");
    const Script name("$d{}", block++);
    out.add("{} << EOD\n{}EOD\n", name, data);
    add(Script("{} using 1:2 {} {}", name, style_of(s), title));
    if (s.style == Series::Style::bar)
      add(
          Script("{} using 1:2:(sprintf($2 < 100 ? '%.3g' : '%.0f', $2 == 0 ? 0 : $2)) with labels offset "
                 "0,0.6 font "
                 "',12' notitle",
                 name));
    if (s.broke_x.empty()) continue;
    const double at = 0.03 + crosses_step * row++;
    const double level = chart.log_y ? y.min * std::pow(y.max / y.min, at) : y.min + at * (y.max - y.min);
    Script crosses;
    for (const double v : s.broke_x) crosses.add("{} {}\n", v, level);
    out.add("$b{} << EOD\n{}EOD\n", block, crosses);
    add(Script("$b{} using 1:2 with points lc rgb {} lw 2.2 pt 2 ps 0.8 notitle", block++,
               Literal(run_colour(s.colour))));
  }
  if (legend.more)
    add(Script("NaN with lines lc rgb '#ffffff' title {}",
               Literal(fmt::format("and {} more, in {}.csv", legend.more, chart.name))));
  return out.add("{}\n", plots);
}

}  // namespace

bool Chart::empty() const {
  return std::all_of(series.begin(), series.end(), [](const Series& s) {
    const bool ours =
        s.style == Series::Style::run || s.style == Series::Style::scatter || s.style == Series::Style::bar;
    return !ours || (s.x.empty() && s.broke_x.empty());
  });
}

int colour_of(const std::string& label) {
  static std::map<std::string, int> given;
  return given.try_emplace(label, static_cast<int>(given.size())).first->second;
}

std::string run_colour(int index) {
  static constexpr std::array<const char*, colours> names = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                             "#E69F00", "#56B4E9", "#8C564B", "#7F7F7F"};
  return index < 0 ? "#111111" : names[static_cast<std::size_t>(index) % names.size()];
}

bool write_chart(const Chart& chart, const std::filesystem::path& folder, std::string& why) {
  write_file(folder / (chart.name + ".csv"), csv_of(chart));
  const Script terminal("svg size {},{} font 'sans-serif,13' noenhanced background '#ffffff' rounded",
                        chart_width, plot_height + 23 * Legend(chart).rows);
  return gnuplot::draw(terminal, script_of(chart), folder / (chart.name + ".svg"), why);
}

}  // namespace taut::bench
