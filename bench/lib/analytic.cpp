#include <fmt/format.h>

#include <array>
#include <cmath>
#include <lib/analytic.hpp>
#include <lib/scene_parts.hpp>
#include <map>
#include <set>
#include <taut/geometry/local_origin.hpp>
#include <taut/materials/hypoelastic_bar.hpp>

namespace taut::bench {
namespace {

/// Speed of a plane wave along x whose sides do not move [m/s].
double wave_speed(const Scene& scene, const MaterialSpec& material) {
  const MaterialParameters& p = material.parameters;
  const double modulus =
      scene.dimension == 2 && p.plane == Plane::stress ? p.E / (1 - p.nu * p.nu) : p.lambda() + 2 * p.mu();
  return std::sqrt(modulus / p.density);
}

double impedance(const Scene& scene, const MaterialSpec& material) {
  return material.parameters.density * wave_speed(scene, material);
}

/// When a history first reaches half its largest factor [s].
double half_time(const HistorySpec& history) {
  if (history.type == "raised_cosine") return history.start + 0.25 * history.duration;
  if (history.type == "linear" || history.type == "smoothstep") return history.start + 0.5 * history.duration;
  return history.start;
}

const BoundarySpec* loaded_end(const Scene& scene) {
  for (const BoundarySpec& boundary : scene.boundaries)
    if (boundary.type == "load" && boundary.history && boundary.history->type != "table" &&
        (boundary.selection.on == "x_min" || boundary.selection.on == "x_max"))
      return &boundary;
  return nullptr;
}

Analytic bar_wave_arrival(const Scene& scene, const RunSpec& run, const SweepPoint& point,
                          const ProbeSpec& probe) {
  const BoundarySpec* load = loaded_end(scene);
  if (!load || scene.geometry.type != "box" || probe.at.empty())
    fail(probe.reference->place,
         "[reference] bar_wave_arrival: needs a box, a load on x_min or x_max with a history (not a table) "
         "and a probe at a point");
  const double from = load->selection.on == "x_min" ? scene.geometry.min[0] : scene.geometry.max[0];
  const double low = std::min(from, probe.at[0]), high = std::max(from, probe.at[0]);
  double time = half_time(*load->history), rest = high - low;
  for (const RegionSpec& region : scene.regions) {
    const auto x = region.selection.where.find(0);
    if (x == region.selection.where.end()) continue;
    const double inside = std::max(0.0, std::min(high, x->second[1]) - std::max(low, x->second[0]));
    time += inside / wave_speed(scene, material_of(scene, region, run, point));
    rest -= inside;
  }
  return {time + rest / wave_speed(scene, material_of(scene, run, point)), {}};
}

/// Stress amplitude behind (transmission) or back from (reflection) a jump of impedance, over the incoming
/// one.
Analytic interface(const Scene& scene, const RunSpec& run, const SweepPoint& point, const ProbeSpec& probe,
                   bool transmitted) {
  if (scene.regions.size() != 1)
    fail(probe.reference->place,
         "[reference] bar_wave_transmission and bar_wave_reflection need exactly one [[region]]");
  const double z1 = impedance(scene, material_of(scene, run, point));
  const double z2 = impedance(scene, material_of(scene, scene.regions[0], run, point));
  return {transmitted ? 2 * z2 / (z1 + z2) : (z2 - z1) / (z2 + z1), {}};
}

/// Pressure of the wave that a load sends into the bar [Pa].
Analytic bar_wave_incident(const Scene& scene, const SweepPoint& point, const ProbeSpec& probe) {
  const BoundarySpec* load = loaded_end(scene);
  if (!load || scene.geometry.type != "box")
    fail(probe.reference->place,
         "[reference] bar_wave_incident: needs a box and a load on x_min or x_max with a history");
  double area = 1;
  for (std::size_t d = 1; d < scene.geometry.min.size(); ++d)
    area *= coordinate_difference(scene.geometry.max[d], scene.geometry.min[d]);
  const double outward = load->selection.on == "x_max" ? 1 : -1;
  const double sign = load->direction[0] * outward > 0 ? 1 : -1;
  return {sign * force_of(*load, point) / area, {}};
}

/// Homogeneous stretch of P = mu (F - F^-T) + lambda ln J F^-T by the displacement of the faces.
Analytic neo_hookean_stretch(const Scene& scene, const RunSpec& run, const SweepPoint& point,
                             const ProbeSpec& probe) {
  static const std::set<std::string> materials = {"neo_hookean"};
  const MaterialSpec material = material_of(scene, run, point);
  const bool plane_stress = scene.dimension == 2 && material.parameters.plane == Plane::stress;
  if (scene.geometry.type != "box" || !materials.contains(material.model) || plane_stress ||
      probe.type != "cauchy_stress" || probe.row != probe.column)
    fail(probe.reference->place,
         "[reference] neo_hookean_stretch: needs a box, material neo_hookean (plane strain) and a probe of a "
         "direct stress");
  const auto stretch = [scene](int axis, double t) {
    if (axis >= scene.dimension) return 1.0;
    const auto i = static_cast<std::size_t>(axis);
    double growth = 0;
    for (const BoundarySpec& b : scene.boundaries)
      if (b.type == "prescribed" && !b.selection.on.empty() && b.axis == axis &&
          axis_number(b.selection.on) == axis)
        growth += (b.selection.on.ends_with("_max") ? 1 : -1) * b.displacement *
                  (b.history ? b.history->factor(t) : 1);
    return 1 + growth / coordinate_difference(scene.geometry.max[i], scene.geometry.min[i]);
  };
  const double mu = material.parameters.mu(), lambda = material.parameters.lambda();
  Analytic exact;
  exact.curve = [=, dimension = scene.dimension, axis = probe.row](double t) {
    double J = 1;
    for (int d = 0; d < dimension; ++d) J *= stretch(d, t);
    const double s = stretch(axis, t);
    return (mu * (s * s - 1) + lambda * std::log(J)) / J;
  };
  exact.value = exact.curve(run.solve.duration);
  return exact;
}

/// Stretch of a bar of St. Venant–Kirchhoff material with free sides under a dead axial stress: S = E (s^2 -
/// 1) / 2 and P = s S, or P = S for the corotated form. Nothing in compression beyond the largest load that
/// the law carries.
std::optional<double> svk_stretch(double E, double stress, bool corotated) {
  if (corotated) {
    const double square = 1 + 2 * stress / E;
    if (square <= 0) return {};
    return std::sqrt(square);
  }
  const double lowest = 1 / std::sqrt(3.0);  // where P(s) = E s (s^2 - 1) / 2 turns
  if (stress < E * lowest * (lowest * lowest - 1) / 2) return {};
  double s = std::max(1.0, std::cbrt(2 * std::abs(stress) / E) + 1);
  for (int i = 0; i < 60; ++i) s -= (E * s * (s * s - 1) / 2 - stress) / (E * (3 * s * s - 1) / 2);
  return s;
}

/// Stretch of a bar with free sides under a dead axial stress, of the materials that have a closed form.
using BarLaw = std::function<std::optional<double>(const MaterialParameters&, double stress)>;
const std::map<std::string, BarLaw>& bar_laws() {
  static const std::map<std::string, BarLaw> laws = {
      {"hypoelastic",
       [](const MaterialParameters& m, double stress) -> std::optional<double> {
         if (const auto state = hypoelastic_bar(m, BarSides::free, stress)) return state->stretch;
         return {};
       }},
      {"st_venant_kirchhoff",
       [](const MaterialParameters& m, double stress) { return svk_stretch(m.E, stress, false); }},
      {"corotated_svk",
       [](const MaterialParameters& m, double stress) { return svk_stretch(m.E, stress, true); }}};
  return laws;
}

/// End displacement of a homogeneous bar of the run's own material.
Analytic own_law_bar(const Scene& scene, const RunSpec& run, const SweepPoint& point,
                     const ProbeSpec& probe) {
  const MaterialSpec material = material_of(scene, run, point);
  const BoundarySpec* load = nullptr;
  for (const BoundarySpec& boundary : scene.boundaries)
    if (boundary.type == "load" && boundary.selection.on == "x_max") load = &boundary;
  const bool plane_stress = scene.dimension == 2 && material.parameters.plane == Plane::stress;
  const auto& laws = bar_laws();
  const auto law = laws.find(material.model);
  if (scene.geometry.type != "box" || !load || !plane_stress || law == laws.end() ||
      probe.type != "displacement" || probe.row != 0)
    fail(probe.reference->place,
         "[reference] own_law_bar: needs a box in plane stress, a load on x_max, material hypoelastic, "
         "st_venant_kirchhoff or "
         "corotated_svk, and a probe of the displacement along x");
  const double height = coordinate_difference(scene.geometry.max[1], scene.geometry.min[1]);
  const double stress = (load->direction[0] > 0 ? 1 : -1) * force_of(*load, point) / height;
  const std::optional<double> stretch = law->second(material.parameters, stress);
  if (!stretch) return {};
  return {(*stretch - 1) * coordinate_difference(scene.geometry.max[0], scene.geometry.min[0]), {}};
}

}  // namespace

std::vector<std::string> analytic_names() {
  return {"bar_wave_arrival",      "bar_wave_incident",   "bar_wave_reflection",
          "bar_wave_transmission", "neo_hookean_stretch", "own_law_bar"};
}

Analytic analytic(const Scene& scene, const RunSpec& run, const SweepPoint& point, const ProbeSpec& probe) {
  const std::string& name = probe.reference->analytic;
  if (name == "bar_wave_arrival") return bar_wave_arrival(scene, run, point, probe);
  if (name == "bar_wave_incident") return bar_wave_incident(scene, point, probe);
  if (name == "bar_wave_reflection") return interface(scene, run, point, probe, false);
  if (name == "bar_wave_transmission") return interface(scene, run, point, probe, true);
  if (name == "own_law_bar") return own_law_bar(scene, run, point, probe);
  return neo_hookean_stretch(scene, run, point, probe);
}

}  // namespace taut::bench
