#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <lib/files.hpp>
#include <lib/names.hpp>
#include <lib/results.hpp>
#include <set>
#include <taut/base/error.hpp>

namespace taut::bench {
namespace {

std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

template <class T>
std::string field(const std::optional<T>& number) {
  return number ? fmt::format("{}", *number) : std::string();
}

/// The fields of one line, quotes taken off.
std::vector<std::string> fields_of(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (quoted && line[i] == '"' && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[i++];
    else if (line[i] == '"')
      quoted = !quoted;
    else if (line[i] == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += line[i];
  }
  return fields;
}

/// Hands out the fields of a line, column by column.
class LineReader {
 public:
  LineReader(const std::string& where, const std::string& line) : where_(where), fields_(fields_of(line)) {}
  std::size_t size() const { return fields_.size(); }
  LineReader& operator>>(std::string& text) {
    text = fields_[next_++];
    return *this;
  }
  template <class T>
  LineReader& operator>>(std::optional<T>& number) {
    const std::string& text = fields_[next_++];
    if (text.empty()) return *this;
    T value{};
    const char* end = text.data() + text.size();
    if (const auto [at, error] = std::from_chars(text.data(), end, value); error != std::errc() || at != end)
      throw InputError(fmt::format("{}: '{}' is not a number", where_, text));
    number = value;
    return *this;
  }

 private:
  std::string where_;
  std::vector<std::string> fields_;
  std::size_t next_ = 0;
};

}  // namespace

void set_method(Row& row, const Method& method) {
  row.formulation = method.formulation;
  if (!has_pairs(method.formulation)) return;
  row.operators = method.operators;
  row.kernel = method.kernel;
  row.support_dx = method.support_dx;
  row.precision = to_string(method.pair_precision);
}

std::string results_header(const std::vector<std::string>& swept) {
  std::string header =
      "scene,formulation,operators,material,kernel,support_dx,dx,particles,pairs,threads,precision,"
      "integrator,steps,time,"
      "quantity,value,reference,error,unit,status,setup_s,loop_s,particle_steps_per_s,bytes_per_particle,"
      "label";
  for (const std::string& name : swept) header += ',' + name;
  return header;
}

std::string results_line(const Row& r, const std::vector<std::string>& swept) {
  std::vector<std::string> fields = {field(r.scene),
                                     field(r.formulation),
                                     field(r.operators),
                                     field(r.material),
                                     field(r.kernel),
                                     field(r.support_dx),
                                     field(r.dx),
                                     field(r.particles),
                                     field(r.pairs),
                                     field(r.threads),
                                     field(r.precision),
                                     field(r.integrator),
                                     field(r.steps),
                                     field(r.time),
                                     field(r.quantity),
                                     field(r.value),
                                     field(r.reference),
                                     field(r.error),
                                     field(r.unit),
                                     field(r.status),
                                     field(r.setup_s),
                                     field(r.loop_s),
                                     field(r.particle_steps_per_s),
                                     field(r.bytes_per_particle),
                                     field(r.label)};
  for (const std::string& name : swept) {
    const auto found = r.swept.find(name);
    fields.push_back(found == r.swept.end() ? "" : fmt::format("{}", found->second));
  }
  return fmt::format("{}", fmt::join(fields, ","));
}

double error_of(double value, double reference, bool absolute) {
  const double difference = value - reference;
  return absolute || reference == 0 ? difference : difference / reference;
}

void write_results(const std::filesystem::path& file, const std::vector<Row>& rows) {
  std::set<std::string> names;
  for (const Row& row : rows)
    for (const auto& [name, value] : row.swept) names.insert(name);
  const std::vector<std::string> swept(names.begin(), names.end());
  std::string text = results_header(swept) + '\n';
  for (const Row& row : rows) text += results_line(row, swept) + '\n';
  write_file(file, text);
}

std::vector<Row> read_results(const std::filesystem::path& file) {
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) throw InputError(file.string() + ": cannot read results");
  if (!(line + ',').starts_with(results_header() + ','))
    throw InputError(fmt::format("{}:1: not the header of results: {}", file.string(), results_header()));
  const std::vector<std::string> names = fields_of(line);
  const std::vector<std::string> swept(
      names.begin() + static_cast<std::ptrdiff_t>(fields_of(results_header()).size()), names.end());
  std::vector<Row> rows;
  for (unsigned number = 2; std::getline(in, line); ++number) {
    Row r;
    const std::string where = fmt::format("{}:{}", file.string(), number);
    LineReader reader(where, line);
    if (reader.size() != names.size())
      throw InputError(fmt::format("{}: has {} fields, not {}", where, reader.size(), names.size()));
    reader >> r.scene >> r.formulation >> r.operators >> r.material >> r.kernel >> r.support_dx >> r.dx >>
        r.particles >> r.pairs >> r.threads >> r.precision >> r.integrator >> r.steps >> r.time >>
        r.quantity >> r.value >> r.reference >> r.error >> r.unit >> r.status >> r.setup_s >> r.loop_s >>
        r.particle_steps_per_s >> r.bytes_per_particle >> r.label;
    for (const std::string& name : swept) {
      std::optional<double> value;
      reader >> value;
      if (value) r.swept[name] = *value;
    }
    rows.push_back(std::move(r));
  }
  return rows;
}

std::string snake_number(double value) {
  std::string digits = value == std::round(value) && std::abs(value) < 1e15
                           ? fmt::format("{:.0f}", std::abs(value))
                           : fmt::format("{:.12g}", std::abs(value));
  std::string name = std::signbit(value) && value != 0 ? "minus_" : "";
  for (const char c : digits)
    if (c == '-')
      name += "_minus_";
    else if (c != '+')
      name += c == '.' ? '_' : c;
  return name;
}

}  // namespace taut::bench
