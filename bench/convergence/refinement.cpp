#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <convergence/refinement.hpp>

namespace taut::bench {
namespace {

std::optional<double> order(const Refinement& r, const RefinementLine& line, std::size_t from,
                            std::size_t to) {
  if (from == to || !line.error[from] || !line.error[to]) return {};
  return order_between(r.h[from], *line.error[from], r.h[to], *line.error[to]);
}

HtmlCell number(std::optional<double> value, const char* format) {
  if (!value) return {"–", "number quiet"};
  return {fmt::format(fmt::runtime(format), *value), "number"};
}

}  // namespace

std::optional<double> mean_of(const std::vector<std::optional<double>>& values) {
  double sum = 0;
  for (const auto& value : values) {
    if (!value) return {};
    sum += *value;
  }
  if (values.empty()) return {};
  return sum / static_cast<double>(values.size());
}

Row shared_columns(const Row& from) {
  Row row;
  row.scene = from.scene;
  row.formulation = from.formulation;
  row.operators = from.operators;
  row.material = from.material;
  row.kernel = from.kernel;
  row.support_dx = from.support_dx;
  row.threads = from.threads;
  row.precision = from.precision;
  row.integrator = from.integrator;
  return row;
}

TextTable order_table(const Refinement& r, const std::string& title, const std::string& note) {
  TextTable table{title, note, {"method"}, {}};
  const std::size_t levels = r.h.size();
  for (const std::string& name : r.names) table.header.push_back("error " + name);
  for (std::size_t k = 1; k < levels; ++k)
    table.header.push_back(fmt::format("order {}–{}", r.names[k - 1], r.names[k]));
  if (levels > 2) table.header.push_back("overall");
  for (const RefinementLine& line : r.lines) {
    std::vector<HtmlCell> row = {{line.label, ""}};
    for (const auto& error : line.error)
      row.push_back(number(error ? std::optional(100 * *error) : error, "{:.3g} %"));
    for (std::size_t k = 1; k < levels; ++k) row.push_back(number(order(r, line, k - 1, k), "{:.2f}"));
    if (levels > 2) row.push_back(number(order(r, line, 0, levels - 1), "{:.2f}"));
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<Row> order_rows(const Refinement& r) {
  std::vector<Row> rows;
  const auto add = [&](const RefinementLine& line, std::size_t from, std::size_t to,
                       const std::string& quantity) {
    const auto value = order(r, line, from, to);
    if (!value) return;
    Row row = line.row;
    row.dx = r.h[to];
    row.quantity = quantity + line.suffix;
    row.value = value;
    row.unit = "1";
    rows.push_back(std::move(row));
  };
  for (const RefinementLine& line : r.lines) {
    for (std::size_t k = 1; k < r.h.size(); ++k) add(line, k - 1, k, "order_" + r.quantity);
    if (r.h.size() > 2) add(line, 0, r.h.size() - 1, "order_" + r.quantity + "_overall");
  }
  return rows;
}

Chart error_chart(const Refinement& r, const std::vector<double>& x, Chart chart) {
  chart.log_x = chart.log_y = true;
  chart.x_ticks = x;
  double coarsest = 0;
  for (const RefinementLine& line : r.lines) {
    Series s{line.label,
             line.yardstick ? Series::Style::truth : Series::Style::run,
             line.yardstick ? 0 : colour_of(line.label),
             {},
             {},
             {},
             true};
    for (std::size_t k = 0; k < x.size(); ++k)
      if (line.error[k] && *line.error[k] > 0) s.x.push_back(x[k]), s.y.push_back(100 * *line.error[k]);
    if (!s.y.empty()) coarsest = std::max(coarsest, s.y.front());
    chart.series.push_back(std::move(s));
  }
  for (const int order : {1, 2})
    chart.series.push_back({order == 1 ? "first order" : "second order",
                            Series::Style::guide,
                            0,
                            {x.front(), x.back()},
                            {coarsest, coarsest * std::pow(r.h.back() / r.h.front(), order)},
                            {},
                            false});
  return chart;
}

}  // namespace taut::bench
