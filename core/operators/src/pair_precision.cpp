#include <fmt/format.h>

#include <taut/base/error.hpp>
#include <taut/operators/pair_precision.hpp>
#include <utility>

namespace taut {

namespace {
constexpr std::pair<const char*, PairPrecision> precisions[] = {{"single", PairPrecision::single_precision},
                                                                {"double", PairPrecision::double_precision},
                                                                {"shared", PairPrecision::shared},
                                                                {"recomputed", PairPrecision::recomputed},
                                                                {"automatic", PairPrecision::automatic}};
}  // namespace

PairPrecision pair_precision(std::string_view name) {
  for (const auto& [known, precision] : precisions)
    if (name == known) return precision;
  throw InputError(
      fmt::format("unknown pair_precision \"{}\"; valid: {}", name, join_names(pair_precision_names())));
}

const char* to_string(PairPrecision precision) {
  for (const auto& [name, known] : precisions)
    if (precision == known) return name;
  return "";
}

std::vector<std::string> pair_precision_names() {
  std::vector<std::string> names;
  for (const auto& [name, precision] : precisions) names.emplace_back(name);
  return names;
}

}  // namespace taut
