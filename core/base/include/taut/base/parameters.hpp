#pragma once
/// \file
/// What a thing that has a name can be told: parameters, as tables that checks, scenes and documents are made
/// from.

#include <functional>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace taut {

/// Numbers from `min` to `max`; without the ends that are `open`.
struct Interval {
  double min = -std::numeric_limits<double>::max(), max = std::numeric_limits<double>::max();
  bool open_min = false, open_max = false;

  static Interval any() { return {}; }
  static Interval positive() { return {0, std::numeric_limits<double>::max(), true, false}; }
  static Interval non_negative() { return {0, std::numeric_limits<double>::max(), false, false}; }
  /// False for what is no finite number.
  bool contains(double value) const;
  /// "at least 0 and less than 1".
  std::string str() const;
};

/// A number or a text.
class ParameterValue {
 public:
  ParameterValue(double number) : value_(number) {}
  ParameterValue(int number) : value_(static_cast<double>(number)) {}
  ParameterValue(const char* text) : value_(std::string(text)) {}
  ParameterValue(std::string text) : value_(std::move(text)) {}

  const double* number() const { return std::get_if<double>(&value_); }          ///< null of a text
  const std::string* text() const { return std::get_if<std::string>(&value_); }  ///< null of a number
  /// "0.3", "corrected".
  std::string str() const;
  friend bool operator==(const ParameterValue&, const ParameterValue&) = default;

 private:
  std::variant<double, std::string> value_;
};

using ParameterMap = std::map<std::string, ParameterValue, std::less<>>;

/// One row of a table.
struct Parameter {
  enum class Type { number, whole, choice };

  std::string name;
  Type type = Type::number;
  /// What stands where it is not given; empty: chosen with the rest. See `required`.
  std::string fallback{};
  Interval range{};                                     ///< of numbers
  std::function<std::vector<std::string>()> choices{};  ///< valid texts, as they are when asked for
  std::string unit{};                                   ///< "m/s"; empty: a pure number or a text
  std::string line{};                                   ///< what it does
  bool required = false;

  /// "number at least 0", "whole number from 1 to 16", "strain or stress".
  std::string domain() const;
  /// The fallback as a value. Only where there is one.
  ParameterValue fallback_value() const;
  /// \throws InputError "viscosity = -1 must not be negative", or listing the valid texts.
  void check(const ParameterValue& value) const;
};

Parameter number_parameter(std::string name, double fallback, Interval range, std::string unit,
                           std::string line);
/// Without a fallback: it must be given.
Parameter required_number(std::string name, Interval range, std::string unit, std::string line);
Parameter whole_parameter(std::string name, int fallback, int least, int most, std::string line);
Parameter choice_parameter(std::string name, std::string fallback, std::vector<std::string> choices,
                           std::string line);

const Parameter* find_parameter(const std::vector<Parameter>& table, std::string_view name);
std::vector<std::string> parameter_names(const std::vector<Parameter>& table);
/// Checks what is given against the table of `owner` ("formulation \"tl_displacement\""), and adds the
/// fallbacks of what is not. \throws InputError for a name that the table does not have (those that it has
/// listed), for a value out of range, and for a required one that is missing.
void complete_parameters(ParameterMap& given, const std::vector<Parameter>& table, const std::string& owner);

/// The number or text of that name. \throws InputError where there is none, or it is of the other kind.
double number_of(const ParameterMap& parameters, std::string_view name);
const std::string& text_of(const ParameterMap& parameters, std::string_view name);

}  // namespace taut
