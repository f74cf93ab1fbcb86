#include <algorithm>
#include <cmath>
#include <lib/scene_parts.hpp>
#include <lib/slowest_mode.hpp>
#include <numbers>
#include <set>

namespace taut::bench {
namespace {

using std::numbers::pi;

/// A part of an axis where one component of the displacement is held.
struct Held {
  double from, to;
  bool turning;  ///< rotations as well
};

/// By component, by axis.
using Supports = std::vector<std::vector<std::vector<Held>>>;

struct Speeds {
  double bar, shear;  // [m/s]
};

bool holds(const BoundarySpec& boundary, int component) {
  if (boundary.type == "clamp") return true;
  if (boundary.type == "roller" || boundary.type == "prescribed") return boundary.axis == component;
  return boundary.type == "symmetry" && axis_number(boundary.selection.on) == component;
}

bool drives(const BoundarySpec& boundary, int component) {
  const auto d = static_cast<std::size_t>(component);
  if (boundary.type == "load") return boundary.direction[d] != 0;
  if (boundary.type == "body_force") return boundary.acceleration[d] != 0;
  return boundary.type == "prescribed" && boundary.axis == component;
}

/// Where a selection lies along an axis; false where it is not told from the body.
bool find_held(const Selection& selection, const BodySize& body, int axis, Held& held) {
  const auto a = static_cast<std::size_t>(axis);
  const double low = body.min[a], high = body.min[a] + body.edges[a];
  const auto interval = selection.where.find(axis);
  if (!selection.on.empty() && axis_number(selection.on) == axis) {
    held.from = held.to = selection.on.ends_with("_min") ? low : high;
    return true;
  }
  if (interval == selection.where.end()) return false;
  held.from = std::clamp(interval->second[0], low, high);
  held.to = std::clamp(interval->second[1], low, high);
  return true;
}

/// First circular frequency of a span that is held at one end or at both, moving along itself or across.
double frequency_of(double span, int ends, bool along, double thickness, bool turning, const Speeds& c) {
  const double wave = ends == 2 ? pi / span : pi / (2 * span);
  if (along) return c.bar * wave;
  // Euler and Bernoulli's beams: clamped at one end, at both, or supported at both.
  const double shape = ends == 1 ? 3.516 : turning ? 22.37 : pi * pi;
  const double bending = shape * c.bar * thickness / std::sqrt(12.0) / (span * span);
  // Compliances add up (Dunkerley).
  return 1 / std::hypot(1 / bending, 1 / (c.shear * wave));
}

/// The free spans between what is held along one axis: the slowest of them.
double slowest_span(std::vector<Held> held, double low, double edge, bool along, double thickness,
                    const Speeds& c) {
  std::sort(held.begin(), held.end(), [](const Held& a, const Held& b) { return a.from < b.from; });
  const bool turning = std::all_of(held.begin(), held.end(), [](const Held& h) { return h.turning; });
  double slowest = 0, at = low;
  const auto span = [&](double to, int ends) {
    if (to - at <= 1e-6 * edge) return;
    const double omega = frequency_of(to - at, ends, along, thickness, turning, c);
    slowest = slowest > 0 ? std::min(slowest, omega) : omega;
  };
  for (std::size_t i = 0; i < held.size(); ++i) {
    span(held[i].from, i ? 2 : 1);
    at = std::max(at, held[i].to);
  }
  span(low + edge, 1);
  return slowest;
}

/// Of a motion along an axis, by everything that holds it: stiffnesses add up. 0 where nothing does.
double frequency_along(int component, const Supports& supports, const BodySize& body, const Speeds& c) {
  const auto k = static_cast<std::size_t>(component);
  double squares = 0;
  for (std::size_t a = 0; a < body.edges.size(); ++a) {
    if (supports[k][a].empty()) continue;
    const double omega = slowest_span(supports[k][a], body.min[a], body.edges[a], a == k, body.edges[k], c);
    squares += omega * omega;
  }
  return std::sqrt(squares);
}

/// The slowest speeds of its materials.
Speeds speeds_of(const Scene& scene, const RunSpec& run, const SweepPoint& point) {
  Speeds slowest{};
  const auto add = [&](const MaterialSpec& material) {
    const MaterialParameters& p = material.parameters;
    const double bar = scene.dimension == 1 ? wave_speed_of(scene, material) : std::sqrt(p.E / p.density);
    const double shear = std::sqrt(p.E / (2 * (1 + p.nu)) / p.density);
    if (slowest.bar == 0 || bar < slowest.bar) slowest = {bar, shear};
  };
  add(material_of(scene, run, point));
  for (const RegionSpec& region : scene.regions) add(material_of(scene, region, run, point));
  return slowest;
}

}  // namespace

double slowest_period(const Scene& scene, const RunSpec& run, const SweepPoint& point, const BodySize& body) {
  const auto dimension = static_cast<std::size_t>(scene.dimension);
  const Speeds c = speeds_of(scene, run, point);
  Supports supports(dimension, std::vector<std::vector<Held>>(dimension));
  std::set<int> driven;
  for (const BoundarySpec& boundary : scene.boundaries)
    for (int k = 0; k < scene.dimension; ++k) {
      if (drives(boundary, k)) driven.insert(k);
      if (!holds(boundary, k)) continue;
      for (int a = 0; a < scene.dimension; ++a)
        if (Held held{0, 0, boundary.type == "clamp"}; find_held(boundary.selection, body, a, held))
          supports[static_cast<std::size_t>(k)][static_cast<std::size_t>(a)].push_back(held);
    }
  double slowest = 0;
  const auto add = [&](double omega) {
    if (omega > 0) slowest = slowest > 0 ? std::min(slowest, omega) : omega;
  };
  for (const int k : driven) add(frequency_along(k, supports, body, c));
  if (slowest == 0)
    for (int k = 0; k < scene.dimension; ++k) add(frequency_along(k, supports, body, c));
  const double longest = *std::max_element(body.edges.begin(), body.edges.end());
  if (slowest == 0) slowest = pi * c.bar / longest;  // free
  // Rings, frames and shells bend their walls, whichever way they are pulled.
  if (body.thickness < 0.4 * *std::min_element(body.edges.begin(), body.edges.end()))
    add(frequency_of(1.05 * longest, 1, false, body.thickness, true, c));
  return 2 * pi / slowest;
}

}  // namespace taut::bench
