#include <algorithm>
#include <cmath>
#include <lib/scene.hpp>
#include <numbers>
#include <taut/materials/registry.hpp>

namespace taut::bench {

void keep_own(MaterialSpec& material) {
  const std::vector<Parameter>& own = material_registry().find(material.model).parameters;
  std::erase_if(material.parameters.other,
                [&](const auto& given) { return !find_parameter(own, given.first); });
}

double HistorySpec::factor(double t) const {
  if (type == "table") {
    if (t <= values.front()[0]) return values.front()[1];
    for (std::size_t i = 1; i < values.size(); ++i)
      if (t <= values[i][0]) {
        const double s = (t - values[i - 1][0]) / (values[i][0] - values[i - 1][0]);
        return (1 - s) * values[i - 1][1] + s * values[i][1];
      }
    return values.back()[1];
  }
  if (type == "constant") return t < start ? 0 : 1;
  const double s = (t - start) / duration;
  const bool inside = s >= 0 && s <= 1;
  if (type == "raised_cosine") return inside ? 0.5 * (1 - std::cos(2 * std::numbers::pi * s)) : 0;
  if (type == "square") return inside ? 1 : 0;
  const double ramp = std::clamp(s, 0.0, 1.0);
  return type == "smoothstep" ? ramp * ramp * (3 - 2 * ramp) : ramp;
}

std::string ProbeSpec::signal_unit() const {
  if (type == "displacement") return "m";
  if (type == "velocity") return "m/s";
  if (type == "cauchy_stress" || type == "von_mises" || type == "pressure") return "Pa";
  if (type == "linear_momentum") return "kg m/s";
  return "J";
}

std::string ProbeSpec::unit() const {
  if (measure == "arrival_time") return "s";
  if (measure == "curve_error" || !over.empty()) return "1";
  return signal_unit();
}

std::vector<SweepPoint> Scene::points() const {
  std::vector<SweepPoint> points{{}};
  for (const auto& [key, values] : sweep) {
    std::vector<SweepPoint> longer;
    for (const SweepPoint& point : points)
      for (const double value : values) {
        longer.push_back(point);
        longer.back()[key] = value;
      }
    points = std::move(longer);
  }
  return points;
}

namespace {

std::optional<double> value_of(const SweepPoint& point, const std::string& name) {
  const auto found = point.find(name);
  if (found == point.end()) return {};
  return found->second;
}

MaterialSpec adapted(MaterialSpec material, const RunSpec& run, const SweepPoint& point) {
  if (!run.material.empty()) {
    material.model = run.material;
    keep_own(material);
  }
  if (run.plane) material.parameters.plane = *run.plane;
  if (const auto nu = value_of(point, "nu")) material.parameters.nu = *nu;
  return material;
}

}  // namespace

MaterialSpec material_of(const Scene& scene, const RunSpec& run, const SweepPoint& point) {
  return adapted(scene.material, run, point);
}

MaterialSpec material_of(const Scene&, const RegionSpec& region, const RunSpec& run,
                         const SweepPoint& point) {
  MaterialSpec material = adapted(region.material, run, point);
  if (const auto density = value_of(point, "region_density")) material.parameters.density = *density;
  return material;
}

LatticeSpec lattice_of(const RunSpec& run, const SweepPoint& point) {
  LatticeSpec lattice = run.lattice;
  if (const auto dx = value_of(point, "dx")) lattice.dx = *dx;
  return lattice;
}

double force_of(const BoundarySpec& boundary, const SweepPoint& point) {
  return value_of(point, "load").value_or(boundary.force);
}

namespace {

template <class T>
bool has(const std::vector<T>& list, const T& value) {
  return list.empty() || std::find(list.begin(), list.end(), value) != list.end();
}

bool matches(const std::map<std::string, std::vector<double>>& wanted_values, const SweepPoint& point) {
  return std::all_of(wanted_values.begin(), wanted_values.end(), [&](const auto& entry) {
    const auto value = value_of(point, entry.first);
    return !value || has(entry.second, *value);
  });
}

}  // namespace

bool wanted(const RunSpec& run, const SweepPoint& point) { return matches(run.only, point); }

bool wanted(const ProbeSpec& probe, const RunSpec& run, const SweepPoint& point) {
  return has(probe.only.runs, run.label) && has(probe.only.formulations, run.method.formulation) &&
         matches(probe.only.values, point);
}

}  // namespace taut::bench
