#include <fmt/format.h>

#include <algorithm>
#include <lib/lists.hpp>
#include <lib/names.hpp>
#include <map>
#include <taut/base/error.hpp>
#include <taut/kernels/registry.hpp>
#include <taut/neighbors/registry.hpp>
#include <taut/operators/registry.hpp>

namespace taut::bench {
namespace {

HtmlCell code(const std::string& name) { return {'`' + name + '`', ""}; }
HtmlCell words(const std::string& text) { return {text, ""}; }
HtmlCell yes(bool is) { return {is ? "yes" : "", ""}; }

std::string keys(const std::vector<Parameter>& parameters) {
  std::string all;
  for (const Parameter& p : parameters) all += (all.empty() ? "`" : ", `") + p.name + '`';
  return all;
}

TextTable formulations() {
  TextTable table{
      "Formulations", "", {"formulation", "what it is", "where it fails", "stress at", "materials"}, {}};
  const std::map<StressAt, std::string> places = {
      {StressAt::particles, "particles"}, {StressAt::bonds, "bonds"}, {StressAt::cells, "cells"}};
  for (const FormulationEntry& e : formulation_registry().entries())
    table.rows.push_back({code(e.name), words(e.line), words(e.fails), words(places.at(e.traits.stress)),
                          words(e.traits.material == MaterialKind::stress ? "hyperelastic" : "hypoelastic")});
  return table;
}

TextTable operators() {
  TextTable table{
      "Operators", "", {"operators", "what they are", "exact for degree", "boundary", "support_dx"}, {}};
  for (const OperatorEntry& e : operator_registry().entries())
    table.rows.push_back({code(e.name), words(e.line), words(fmt::format("{}", e.traits.exact)),
                          words(e.traits.areas ? "needed" : ""),
                          words(fmt::format("{:g}", e.traits.support_dx))});
  return table;
}

TextTable kernels() {
  TextTable table{"Kernels", "", {"kernel", "what it is", "R/h"}, {}};
  for (const KernelEntry& e : kernel_registry().entries())
    table.rows.push_back({code(e.name), words(e.line), words(fmt::format("{:g}", e.radius_factor))});
  return table;
}

TextTable materials() {
  TextTable table{"Materials", "", {"material", "law", "gives", "energy", "plane stress", "own keys"}, {}};
  for (const MaterialEntry& e : material_registry().entries())
    table.rows.push_back({code(e.name), words(e.line),
                          words(e.traits.kind == MaterialKind::stress ? "stress" : "stress rate"),
                          yes(e.traits.energy), yes(e.traits.plane_stress), words(keys(e.parameters))});
  return table;
}

TextTable neighbours() {
  TextTable table{"Neighbour searches", "", {"neighbours", "what it is"}, {}};
  for (const SearchEntry& e : search_registry().entries())
    table.rows.push_back({code(e.name), words(e.line)});
  return table;
}

TextTable integrators() {
  TextTable table{"Integrators", "", {"integrator"}, {}};
  for (const std::string& name : names().integrators) table.rows.push_back({code(name)});
  return table;
}

/// One row for each that differs from others of its name, with those that have it.
TextTable run_keys() {
  TextTable table{"Keys of formulations and operators", "", {"key", "type", "default", "of", "meaning"}, {}};
  struct Key {
    Parameter parameter;
    std::vector<std::string> owners;
  };
  std::vector<Key> all;
  const auto add = [&](const std::string& owner, const std::vector<Parameter>& parameters) {
    for (const Parameter& p : parameters) {
      const auto same = std::find_if(all.begin(), all.end(), [&](const Key& k) {
        return k.parameter.name == p.name && k.parameter.line == p.line &&
               k.parameter.fallback == p.fallback && k.parameter.domain() == p.domain();
      });
      if (same != all.end())
        same->owners.push_back(owner);
      else
        all.push_back({p, {owner}});
    }
  };
  for (const FormulationEntry& e : formulation_registry().entries()) add(e.name, e.parameters);
  for (const OperatorEntry& e : operator_registry().entries()) add(e.name, e.parameters);
  // Names of registries have lists of their own.
  const auto type = [](const Parameter& p) {
    if (p.type != Parameter::Type::choice) return p.domain();
    return p.choices().size() > 5 || p.choices() == names().operators ? "name" : p.domain();
  };
  // Keys of the same name stand together.
  std::map<std::string, std::size_t> first;
  for (const Key& k : all) first.try_emplace(k.parameter.name, first.size());
  std::stable_sort(all.begin(), all.end(), [&](const Key& a, const Key& b) {
    return first.at(a.parameter.name) < first.at(b.parameter.name);
  });
  for (const Key& k : all) {
    std::string owners;
    for (const std::string& owner : k.owners) owners += (owners.empty() ? "`" : ", `") + owner + '`';
    const Parameter& p = k.parameter;
    table.rows.push_back({code(p.name), words(type(p)), words(p.required ? "required" : p.fallback),
                          words(owners), words(p.line + (p.unit.empty() ? "" : " [" + p.unit + ']'))});
  }
  return table;
}

struct List {
  const char* kind;
  TextTable (*table)();
};
const List lists[] = {{"formulations", formulations},
                      {"operators", operators},
                      {"kernels", kernels},
                      {"materials", materials},
                      {"neighbours", neighbours},
                      {"integrators", integrators},
                      {"keys", run_keys}};

}  // namespace

std::vector<std::string> list_kinds() {
  std::vector<std::string> all;
  for (const List& list : lists) all.emplace_back(list.kind);
  return all;
}

TextTable list_of(const std::string& kind) {
  for (const List& list : lists)
    if (kind == list.kind) return list.table();
  throw InputError(fmt::format("there is no list of {}; valid: {}", kind, join_names(list_kinds())));
}

std::string listing(const TextTable& table) {
  TextTable bare = table;
  for (auto& row : bare.rows)
    for (HtmlCell& cell : row) std::erase(cell.text, '`');
  return plain(bare);
}

std::string markdown(const TextTable& table) {
  std::string text = "|", rule = "|";
  for (const std::string& h : table.header) {
    text += ' ' + h + " |";
    rule += "---|";
  }
  text += '\n' + rule + '\n';
  for (const auto& row : table.rows) {
    text += '|';
    for (const HtmlCell& cell : row) text += (cell.text.empty() ? "" : ' ' + cell.text) + " |";
    text += '\n';
  }
  return text;
}

}  // namespace taut::bench
