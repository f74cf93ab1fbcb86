#include <fmt/format.h>

#include <cmath>
#include <taut/base/error.hpp>
#include <taut/base/parameters.hpp>
#include <utility>

namespace taut {

namespace {

constexpr double largest = std::numeric_limits<double>::max();

// What a number must be, as errors say it.
std::string must(const Parameter& p) {
  const Interval& r = p.range;
  const bool low = r.min > -largest, high = r.max < largest;
  if (p.type == Parameter::Type::whole)
    return fmt::format("must be a whole number from {:.0f} to {:.0f}", r.min, r.max);
  if (low && high && r.min == 0 && !r.open_min)
    return fmt::format("must not be negative, and {} {:g}", r.open_max ? "less than" : "at most", r.max);
  if (low && high)
    return fmt::format("must lie between {:g}{} and {:g}{}", r.min, r.open_min ? " (excluded)" : "", r.max,
                       r.open_max ? " (excluded)" : "");
  if (low && r.min == 0)
    return r.open_min ? "must be positive and finite" : "must not be negative, and finite";
  return "must be " + r.str();
}

std::string either(const std::vector<std::string>& names) {
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i)
    all += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
  return all;
}

}  // namespace

bool Interval::contains(double value) const {
  return (open_min ? value > min : value >= min) && (open_max ? value < max : value <= max);
}

std::string Interval::str() const {
  const bool low = min > -largest, high = max < largest;
  const char* above = open_min ? "greater than" : "at least";
  const char* below = open_max ? "less than" : "at most";
  if (low && high) return fmt::format("{} {:g} and {} {:g}", above, min, below, max);
  if (low) return fmt::format("{} {:g}", above, min);
  if (high) return fmt::format("{} {:g}", below, max);
  return "any finite number";
}

std::string ParameterValue::str() const { return number() ? fmt::format("{:g}", *number()) : *text(); }

std::string Parameter::domain() const {
  switch (type) {
    case Type::choice:
      return either(choices());
    case Type::whole:
      return fmt::format("whole number from {:.0f} to {:.0f}", range.min, range.max);
    default:
      return range.min <= -largest && range.max >= largest ? "number" : "number " + range.str();
  }
}

ParameterValue Parameter::fallback_value() const {
  if (type == Type::choice) return fallback;
  return std::stod(fallback);
}

void Parameter::check(const ParameterValue& value) const {
  if (type == Type::choice) {
    const std::vector<std::string> valid = choices();
    if (!value.text())
      throw InputError(fmt::format("{} = {} must be one of: {}", name, value.str(), join_names(valid)));
    for (const std::string& known : valid)
      if (*value.text() == known) return;
    throw InputError(fmt::format("unknown {} \"{}\"; valid: {}", name, *value.text(), join_names(valid)));
  }
  if (!value.number()) throw InputError(fmt::format("{} = \"{}\" {}", name, *value.text(), must(*this)));
  const double number = *value.number();
  if (!range.contains(number) || (type == Type::whole && number != std::floor(number)))
    throw InputError(fmt::format("{} = {:g} {}", name, number, must(*this)));
}

Parameter number_parameter(std::string name, double fallback, Interval range, std::string unit,
                           std::string line) {
  return {.name = std::move(name),
          .fallback = fmt::format("{}", fallback),
          .range = range,
          .unit = std::move(unit),
          .line = std::move(line)};
}

Parameter required_number(std::string name, Interval range, std::string unit, std::string line) {
  return {.name = std::move(name),
          .range = range,
          .unit = std::move(unit),
          .line = std::move(line),
          .required = true};
}

Parameter whole_parameter(std::string name, int fallback, int least, int most, std::string line) {
  return {.name = std::move(name),
          .type = Parameter::Type::whole,
          .fallback = fmt::format("{}", fallback),
          .range = {static_cast<double>(least), static_cast<double>(most)},
          .line = std::move(line)};
}

Parameter choice_parameter(std::string name, std::string fallback, std::vector<std::string> choices,
                           std::string line) {
  return {.name = std::move(name),
          .type = Parameter::Type::choice,
          .fallback = std::move(fallback),
          .choices = [all = std::move(choices)] { return all; },
          .line = std::move(line)};
}

const Parameter* find_parameter(const std::vector<Parameter>& table, std::string_view name) {
  for (const Parameter& p : table)
    if (p.name == name) return &p;
  return nullptr;
}

std::vector<std::string> parameter_names(const std::vector<Parameter>& table) {
  std::vector<std::string> names;
  for (const Parameter& p : table) names.push_back(p.name);
  return names;
}

void complete_parameters(ParameterMap& given, const std::vector<Parameter>& table, const std::string& owner) {
  for (const auto& [name, value] : given) {
    const Parameter* known = find_parameter(table, name);
    if (!known)
      throw InputError(fmt::format("{} has no parameter \"{}\"; it has: {}", owner, name,
                                   table.empty() ? "none" : join_names(parameter_names(table))));
    known->check(value);
  }
  for (const Parameter& p : table) {
    if (given.contains(p.name)) continue;
    if (p.required) throw InputError(fmt::format("{} needs the parameter \"{}\"", owner, p.name));
    if (!p.fallback.empty()) given.emplace(p.name, p.fallback_value());
  }
}

namespace {
const ParameterValue& value_of(const ParameterMap& parameters, std::string_view name) {
  const auto found = parameters.find(name);
  if (found == parameters.end()) throw InputError(fmt::format("no parameter \"{}\" is given", name));
  return found->second;
}
}  // namespace

double number_of(const ParameterMap& parameters, std::string_view name) {
  const ParameterValue& value = value_of(parameters, name);
  if (!value.number()) throw InputError(fmt::format("the parameter \"{}\" is a text, not a number", name));
  return *value.number();
}

const std::string& text_of(const ParameterMap& parameters, std::string_view name) {
  const ParameterValue& value = value_of(parameters, name);
  if (!value.text()) throw InputError(fmt::format("the parameter \"{}\" is a number, not a text", name));
  return *value.text();
}

}  // namespace taut
