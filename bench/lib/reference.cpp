#include <fmt/format.h>

#include <cmath>
#include <lib/analytic.hpp>
#include <lib/csv_table.hpp>
#include <lib/reference.hpp>

namespace taut::bench {
namespace {

/// Row of the reference file whose key columns hold the sweep point's values. \throws InputError for two
std::optional<std::size_t> find_row(const CsvTable& table, const ReferenceSpec& reference,
                                    const SweepPoint& point) {
  std::optional<std::size_t> found;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    bool match = true;
    for (const auto& [name, column] : reference.keys) {
      const auto wanted = point.find(name);
      if (wanted == point.end())
        fail(reference.place, fmt::format("[reference] keys: the scene does not sweep '{}'", name));
      const auto& cell = table.at(row, table.column(column));
      match =
          match && cell.value && std::abs(*cell.value - wanted->second) <= 1e-9 * std::abs(wanted->second);
    }
    if (match && found)
      throw InputError(fmt::format("{}:{}: has the same keys as line {}", reference.file, table.line(row),
                                   table.line(*found)));
    if (match) found = row;
  }
  return found;
}

CsvTable open(const ReferenceSpec& reference) {
  try {
    return CsvTable(reference.file);
  } catch (const InputError& error) {
    fail(reference.place, std::string("[reference] ") + error.what());
  }
}

}  // namespace

std::optional<double> reference_value(const Scene& scene, const RunSpec& run, const SweepPoint& point,
                                      const ProbeSpec& probe) {
  if (!probe.reference) return {};
  const ReferenceSpec& reference = *probe.reference;
  if (reference.number) return reference.number;
  if (!reference.analytic.empty()) return analytic(scene, run, point, probe).value;
  const CsvTable table = open(reference);
  try {
    const auto row = find_row(table, reference, point);
    if (!row) {
      std::string wanted;
      for (const auto& [name, column] : reference.keys)
        wanted += fmt::format("{}{} = {:g}", wanted.empty() ? "" : ", ", column, point.at(name));
      throw InputError(fmt::format("{}: has no row with {}", reference.file, wanted));
    }
    const auto& cell = table.at(*row, table.column(reference.column));
    if (!cell.value) return {};
    const double value = *cell.value * reference.scale;
    if (!std::isfinite(value))
      throw InputError(fmt::format("{}:{}: {:g} times the scale {:g} is no finite number", reference.file,
                                   table.line(*row), *cell.value, reference.scale));
    return value;
  } catch (const InputError& error) {
    const std::string what = error.what();
    if (what.starts_with(reference.place.str())) throw;
    fail(reference.place, "[reference] " + what);
  }
}

PrintedValue printed_value(const ProbeSpec& probe, const PrintedSpec& printed, const SweepPoint& point) {
  const CsvTable table = open(*probe.reference);
  try {
    const auto row = find_row(table, *probe.reference, point);
    if (!row) return {};
    const auto& cell = table.at(*row, table.column(printed.column));
    if (!cell.value) return {{}, cell.broke};
    return {*cell.value * printed.scale, false};
  } catch (const InputError& error) {
    fail(probe.reference->place, std::string("[printed] ") + error.what());
  }
}

}  // namespace taut::bench
