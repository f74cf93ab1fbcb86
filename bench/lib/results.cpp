#include <fmt/format.h>

#include <cmath>
#include <lib/files.hpp>
#include <lib/results.hpp>

namespace taut::bench {
namespace {

std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

template <class T>
std::string field(const std::optional<T>& number) {
  return number ? fmt::format("{}", *number) : std::string();
}

}  // namespace

std::string results_header() {
  return "scene,formulation,operators,material,kernel,support_dx,dx,particles,pairs,threads,precision,"
         "integrator,steps,time,"
         "quantity,value,reference,error,unit,status,setup_s,loop_s,particle_steps_per_s,bytes_per_particle";
}

std::string results_line(const Row& r) {
  const std::string fields[] = {field(r.scene),
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
                                field(r.bytes_per_particle)};
  return fmt::format("{}", fmt::join(fields, ","));
}

double error_of(double value, double reference, bool absolute) {
  const double difference = value - reference;
  return absolute || reference == 0 ? difference : difference / reference;
}

void write_results(const std::filesystem::path& file, const std::vector<Row>& rows) {
  std::string text = results_header() + '\n';
  for (const Row& row : rows) text += results_line(row) + '\n';
  write_file(file, text);
}

std::string snake_number(double value) {
  std::string digits = value == std::round(value) && std::abs(value) < 1e15
                           ? fmt::format("{:.0f}", std::abs(value))
                           : fmt::format("{:g}", std::abs(value));
  std::string name = std::signbit(value) && value != 0 ? "minus_" : "";
  for (const char c : digits)
    if (c == '-')
      name += "_minus_";
    else if (c != '+')
      name += c == '.' ? '_' : c;
  return name;
}

}  // namespace taut::bench
