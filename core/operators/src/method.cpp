#include <fmt/format.h>

#include <cmath>
#include <taut/base/error.hpp>
#include <taut/operators/method.hpp>
#include <variant>

namespace taut {

namespace {

/// The members of a method that are parameters, by their names.
struct Member {
  std::string_view name;
  std::variant<double Method::*, int Method::*, std::string Method::*, std::optional<double> Method::*,
               PairPrecision Method::*>
      at;
};

constexpr Member members[] = {{"operators", &Method::operators},
                              {"kernel", &Method::kernel},
                              {"support_dx", &Method::support_dx},
                              {"neighbours", &Method::neighbours},
                              {"pair_precision", &Method::pair_precision},
                              {"compatible_iterations", &Method::compatible_iterations},
                              {"zero_energy_control", &Method::zero_energy_control},
                              {"viscosity", &Method::viscosity},
                              {"skin", &Method::skin},
                              {"velocity_gradient", &Method::velocity_gradient},
                              {"artificial_stress", &Method::artificial_stress},
                              {"artificial_stress_exponent", &Method::artificial_stress_exponent},
                              {"artificial_stress_weight", &Method::artificial_stress_weight}};

const Member* member(std::string_view name) {
  for (const Member& m : members)
    if (m.name == name) return &m;
  return nullptr;
}

/// Reads a member; empty texts and a support of zero leave it open.
struct Read {
  const Method& method;
  using Value = std::optional<ParameterValue>;

  Value operator()(double Method::*at) const {
    if (at == &Method::support_dx && method.support_dx == 0) return {};
    return method.*at;
  }
  Value operator()(int Method::*at) const { return ParameterValue(method.*at); }
  Value operator()(std::string Method::*at) const {
    return (method.*at).empty() ? Value() : ParameterValue(method.*at);
  }
  Value operator()(std::optional<double> Method::*at) const {
    return method.*at ? Value(*(method.*at)) : Value();
  }
  Value operator()(PairPrecision Method::*at) const { return ParameterValue(to_string(method.*at)); }
};

struct Write {
  Method& method;
  std::string_view name;
  const ParameterValue& value;

  double number() const {
    if (!value.number()) throw InputError(fmt::format("{} = \"{}\" must be a number", name, *value.text()));
    return *value.number();
  }
  const std::string& text() const {
    if (!value.text()) throw InputError(fmt::format("{} = {} must be a text", name, value.str()));
    return *value.text();
  }
  void operator()(double Method::*at) const { method.*at = number(); }
  void operator()(int Method::*at) const {
    if (!(std::abs(number()) <= 1e9) || number() != std::floor(number()))
      throw InputError(fmt::format("{} = {:g} must be a whole number", name, number()));
    method.*at = static_cast<int>(number());
  }
  void operator()(std::string Method::*at) const { method.*at = text(); }
  void operator()(std::optional<double> Method::*at) const { method.*at = number(); }
  void operator()(PairPrecision Method::*at) const { method.*at = pair_precision(text()); }
};

}  // namespace

bool is_member(std::string_view name) { return member(name) != nullptr; }

std::optional<ParameterValue> given_parameter(const Method& method, std::string_view name) {
  if (const Member* m = member(name)) return std::visit(Read{method}, m->at);
  const auto found = method.parameters.find(name);
  if (found == method.parameters.end()) return {};
  return found->second;
}

void set_parameter(Method& method, std::string_view name, const ParameterValue& value) {
  if (const Member* m = member(name))
    std::visit(Write{method, name, value}, m->at);
  else
    method.parameters.insert_or_assign(std::string(name), value);
}

void settle_parameters(Method& method) {
  for (auto at = method.parameters.begin(); at != method.parameters.end();) {
    if (!member(at->first)) {
      ++at;
      continue;
    }
    set_parameter(method, at->first, at->second);
    at = method.parameters.erase(at);
  }
}

}  // namespace taut
