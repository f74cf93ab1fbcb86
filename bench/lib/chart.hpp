#pragma once
/// \file
/// Line charts as SVG through gnuplot, with their numbers as CSV beside them.

#include <filesystem>
#include <string>
#include <vector>

namespace taut::bench {

struct Series {
  enum class Style {
    truth,    ///< black line, drawn on top of nothing else
    run,      ///< coloured line with filled marks
    scatter,  ///< filled marks of the run's colour, no line
    printed,  ///< hollow marks of the run's colour, no line
    guide,    ///< thin grey dashed line
    bar       ///< bars at the places of `Chart::x_names`, beside those of other series, with their values
  };
  std::string label;
  Style style = Style::run;
  int colour = 0;  ///< index of a run: the same colour in every chart; −1: black
  std::vector<double> x, y;
  std::vector<double> broke_x;  ///< where the run broke: crosses along the lower edge
  bool marks = true;
  int mark = -1;          ///< index of a mark; −1: that of the colour
  bool in_legend = true;  ///< where it has a label
  bool wild = false;      ///< of a run that broke: does not stretch the axes far beyond what others need
};

/// Text right of a place in a chart.
struct ChartLabel {
  double x = 0, y = 0;
  std::string text;
};

struct Chart {
  std::string name;  ///< of the files
  std::string title, caption, x_label, y_label;
  bool log_x = false, log_y = false;
  bool line_at_zero = false;
  std::vector<Series> series = {};
  std::vector<double> x_ticks = {};       ///< on a logarithmic axis, instead of automatic ones
  std::vector<std::string> x_names = {};  ///< what stands at x = 0, 1, …, instead of numbers
  std::vector<ChartLabel> labels = {};

  bool empty() const;
};

/// Index of a label: the same whenever it is asked for, so that what is called alike has one colour in every
/// chart, table and picture. Indices are given away in the order of the first questions.
int colour_of(const std::string& label);

/// Colour of a run, "#rrggbb": Okabe and Ito's set, told apart by colour-blind readers too. Black below 0.
std::string run_colour(int index);

/// Writes FOLDER/NAME.csv and, where gnuplot works, FOLDER/NAME.svg. False without the SVG. \throws RunError
bool write_chart(const Chart& chart, const std::filesystem::path& folder, std::string& why);

}  // namespace taut::bench
