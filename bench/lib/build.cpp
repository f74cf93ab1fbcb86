#include <algorithm>
#include <lib/build.hpp>
#include <lib/scene_parts.hpp>
#include <limits>
#include <taut/formulations/registry.hpp>
#include <taut/geometry/local_origin.hpp>

namespace taut::bench {
namespace {

/// What the library says of its arguments, at the place in the scene that gave them.
template <class F>
auto at_place(const Place& place, const char* table, F&& call) {
  try {
    return call();
  } catch (const InputError& error) {
    fail(place, std::string("[") + table + "] " + error.what());
  }
}

template <int D>
Vec<D> vec(const std::vector<double>& values) {
  Vec<D> v;
  for (int d = 0; d < D; ++d) v[d] = values[static_cast<std::size_t>(d)];
  return v;
}

/// The union of many shapes in one go: a chain of `|` copies itself for each, and is as deep as they are
/// many.
template <int D>
Shape<D> any_of(std::vector<Shape<D>> parts) {
  Vec<D> min = parts.front().min(), max = parts.front().max();
  for (const Shape<D>& part : parts) {
    min = min.cwiseMin(part.min());
    max = max.cwiseMax(part.max());
  }
  const auto shared = std::make_shared<const std::vector<Shape<D>>>(std::move(parts));
  return Shape<D>(
      [shared](const Vec<D>& X) {
        return std::any_of(shared->begin(), shared->end(), [&](const Shape<D>& part) {
          return (X.array() >= part.min().array()).all() && (X.array() <= part.max().array()).all() &&
                 part.contains(X);
        });
      },
      min, max);
}

template <int D>
Shape<D> make_shape(const ShapeSpec& spec) {
  if (spec.type == "box") return box<D>(vec<D>(spec.min), vec<D>(spec.max));
  if (spec.type == "sphere") return sphere<D>(vec<D>(spec.centre), spec.radius);
  if (spec.type == "ring") return ring<D>(vec<D>(spec.centre), spec.inner_radius, spec.outer_radius);
  if constexpr (D == 3)
    if (spec.type == "cylinder") return cylinder(vec<3>(spec.from), vec<3>(spec.to), spec.radius);
  std::vector<Shape<D>> parts;
  for (const ShapeSpec& part : spec.of) parts.push_back(make_shape<D>(part));
  if (spec.type == "difference") {
    const Shape<D> whole = parts.front();
    parts.erase(parts.begin());
    return whole - (parts.size() == 1 ? parts.front() : any_of(std::move(parts)));
  }
  return any_of(std::move(parts));
}

/// The body's bounding box without clamp layers, and how far from a face its particles may lie.
template <int D>
struct Bounds {
  Vec<D> min, max;
  double tolerance = 0;
  double condition_tolerance = 0;  // of what conditions select: facets lie on the faces themselves

  /// What coordinates here may be off by, as they were rounded.
  double rounding() const {
    return coordinate_rounding(std::max(min.cwiseAbs().maxCoeff(), max.cwiseAbs().maxCoeff()));
  }
};

template <int D>
Bounds<D> bounds_of(const Scene& scene, const RunSpec& run, const SweepPoint& point, const Cloud<D>& cloud) {
  Bounds<D> bounds;
  const bool facets = needs_areas(run.method) && !cloud.facets.empty();
  if (scene.geometry.type == "csv") {
    bounds.min.setConstant(std::numeric_limits<double>::max());
    bounds.max = -bounds.min;
    const auto include = [&](const Vec<D>& X) {
      bounds.min = bounds.min.cwiseMin(cloud.origin + X);
      bounds.max = bounds.max.cwiseMax(cloud.origin + X);
    };
    for (const Vec<D>& X : cloud.X) include(X);
    if (facets)
      for (const Facet<D>& facet : cloud.facets) include(facet.centre);
    bounds.tolerance = 0.25 * cloud.dx;
    bounds.condition_tolerance = facets ? 1e-3 * cloud.dx : bounds.tolerance;
    return bounds;
  }
  const Shape<D> shape = make_shape<D>(scene.geometry);
  bounds.min = shape.min();
  bounds.max = shape.max();
  // Cell-centred particles of a face lie half a cell inside it, and cells are no wider than 1.5 dx.
  const LatticeSpec lattice = lattice_of(run, point);
  bounds.tolerance = (lattice.kind == Lattice::cell_centred ? 0.75 : 1e-6) * lattice.dx + bounds.rounding();
  bounds.condition_tolerance = facets ? 1e-3 * cloud.dx + bounds.rounding() : bounds.tolerance;
  return bounds;
}

template <int D>
Where<D> where_of(const Selection& selection, const Bounds<D>& bounds, bool beyond_face) {
  return [=](const Vec<D>& X) {
    for (const auto& [axis, interval] : selection.where) {
      const double slack = 1e-9 * (bounds.max - bounds.min).maxCoeff() + bounds.rounding();
      if (X[axis] < interval[0] - slack || X[axis] > interval[1] + slack) return false;
    }
    if (selection.on.empty()) return true;
    const int axis = axis_number(selection.on);
    const bool low = selection.on.ends_with("_min");
    const double inside = low ? X[axis] - bounds.min[axis] : bounds.max[axis] - X[axis];
    return beyond_face ? inside < 0 : inside <= bounds.tolerance;
  };
}

History history_of(const BoundarySpec& boundary) {
  if (!boundary.history) return {};
  return [history = *boundary.history](double t) { return history.factor(t); };
}

template <int D>
void apply(Simulation<D>& simulation, const BoundarySpec& boundary, Bounds<D> bounds, const RunSpec& run,
           const SweepPoint& point) {
  bounds.tolerance = bounds.condition_tolerance;
  const bool layers = boundary.layers > 0 && run.lattice.kind == Lattice::cell_centred;
  const Where<D> where = where_of(boundary.selection, bounds, layers);
  if (boundary.type == "clamp") {
    simulation.clamp(where);
  } else if (boundary.type == "roller") {
    simulation.roller(where, boundary.axis);
  } else if (boundary.type == "prescribed") {
    simulation.prescribe(
        where, boundary.axis,
        [u = boundary.displacement, h = history_of(boundary)](double t) { return h ? u * h(t) : u; });
  } else if (boundary.type == "load") {
    simulation.load(where, force_of(boundary, point) * vec<D>(boundary.direction).stableNormalized(),
                    history_of(boundary));
  } else if (boundary.type == "body_force") {
    simulation.body_force(vec<D>(boundary.acceleration), history_of(boundary));
  } else if (boundary.type == "periodic") {
    simulation.periodic(boundary.axis, bounds.min[boundary.axis], bounds.max[boundary.axis]);
  } else {
    const int axis = axis_number(boundary.selection.on);
    simulation.symmetry_plane(axis,
                              boundary.selection.on.ends_with("_max") ? bounds.max[axis] : bounds.min[axis]);
  }
}

/// The simulation asks for the initial state later, so the functions own what they need.
template <int D>
void set_initial_state(Simulation<D>& simulation, const Scene& scene, const Bounds<D>& bounds) {
  if (scene.initial.empty()) return;
  const auto at = [bounds, all = scene.initial](const Vec<D>& X, auto&& add) {
    Vec<D> sum = Vec<D>::Zero();
    for (const InitialSpec& initial : all)
      if (where_of(initial.selection, bounds, false)(X)) add(initial, sum);
    return sum;
  };
  simulation.set_velocity([at](const Vec<D>& X) {
    return at(X, [](const InitialSpec& initial, Vec<D>& v) {
      if (!initial.velocity.empty()) v = vec<D>(initial.velocity);
    });
  });
  simulation.set_displacement([at, bounds](const Vec<D>& X) {
    return at(X, [&](const InitialSpec& initial, Vec<D>& u) {
      if (!initial.stretch.empty())
        u = (vec<D>(initial.stretch).array() - 1)
                .matrix()
                .cwiseProduct(coordinate_difference<D>(X, bounds.min));
    });
  });
}

template <int D>
std::shared_ptr<const Material<D>> build_material(const MaterialSpec& spec) {
  return at_place(spec.place, "material", [&]() -> std::shared_ptr<const Material<D>> {
    return make_material<D>(spec.model, spec.parameters);
  });
}

template <int D>
double shortest_edge_of(const ShapeSpec& geometry) {
  const Shape<D> shape = at_place(geometry.place, "geometry", [&] { return make_shape<D>(geometry); });
  return coordinate_difference<D>(shape.max(), shape.min()).minCoeff();
}

template <int D>
BodySize body_size_of(const ShapeSpec& geometry) {
  const Shape<D> shape = at_place(geometry.place, "geometry", [&] { return make_shape<D>(geometry); });
  const Vec<D> size = shape.max() - shape.min();
  BodySize body{
      {shape.min().data(), shape.min().data() + D}, {size.data(), size.data() + D}, 1, size.minCoeff()};
  if (geometry.type == "box") return body;
  constexpr int samples = D == 3 ? 24 : D == 2 ? 100 : 1000;
  int all = 1;
  for (int d = 0; d < D; ++d) all *= samples;
  std::vector<char> inside(static_cast<std::size_t>(all));
  for (int i = 0; i < all; ++i) {
    Vec<D> X = shape.min();
    for (int d = 0, rest = i; d < D; ++d, rest /= samples) X[d] += (rest % samples + 0.5) / samples * size[d];
    inside[static_cast<std::size_t>(i)] = shape.contains(X);
  }
  body.fraction = static_cast<double>(std::count(inside.begin(), inside.end(), 1)) / all;
  for (int d = 0, stride = 1; d < D; ++d, stride *= samples) {
    double chords = 0, shares = 0;  // the sum of 1/length over the chords, and of the samples in them
    for (int i = 0; i < all; ++i) {
      if (i / stride % samples != 0) continue;
      int length = 0;
      for (int k = 0; k <= samples; ++k)
        if (k < samples && inside[static_cast<std::size_t>(i + k * stride)]) {
          ++length;
        } else if (length > 0) {
          chords += 1;
          shares += 1.0 / length;
          length = 0;
        }
    }
    if (shares > 0) body.thickness = std::min(body.thickness, chords / shares / samples * size[d]);
  }
  return body;
}

}  // namespace

BodySize body_size(const Scene& scene) {
  if (scene.dimension == 1) return body_size_of<1>(scene.geometry);
  if (scene.dimension == 2) return body_size_of<2>(scene.geometry);
  return body_size_of<3>(scene.geometry);
}

double wave_speed_of(const Scene& scene, const MaterialSpec& material) {
  if (scene.dimension == 1) return build_material<1>(material)->wave_speed();
  if (scene.dimension == 2) return build_material<2>(material)->wave_speed();
  return build_material<3>(material)->wave_speed();
}

double shortest_edge(const Scene& scene) {
  if (scene.dimension == 1) return shortest_edge_of<1>(scene.geometry);
  if (scene.dimension == 2) return shortest_edge_of<2>(scene.geometry);
  return shortest_edge_of<3>(scene.geometry);
}

namespace {

template <int D>
void add_facts(const Scene& scene, AutoFacts& facts) {
  try {
    const Cloud<D> cloud = read_cloud<D>(scene.geometry.file);
    facts.inside = lies_inside(cloud);
    facts.support = spanning_support(cloud);
  } catch (const InputError&) {
    // said with its place when the cloud is built
  }
}

}  // namespace

void add_facts_of_file(const Scene& scene, AutoFacts& facts) {
  if (scene.dimension == 1) add_facts<1>(scene, facts);
  if (scene.dimension == 2) add_facts<2>(scene, facts);
  if (scene.dimension == 3) add_facts<3>(scene, facts);
}

template <int D>
Cloud<D> build_cloud(const Scene& scene, const RunSpec& run, const SweepPoint& point) {
  const ShapeSpec& geometry = scene.geometry;
  if (geometry.type == "csv")
    return at_place(geometry.place, "geometry", [&] { return read_cloud<D>(geometry.file); });
  const LatticeSpec lattice = lattice_of(run, point);
  LatticeOptions options;
  options.dx = lattice.dx;
  options.lattice = lattice.kind;
  options.jitter = lattice.jitter;
  options.seed = lattice.seed;
  // Cell-centred ones have none, which the formulation says better.
  options.cells = formulation_traits(run.method.formulation).cells && lattice.kind == Lattice::node_centred;
  if (lattice.kind == Lattice::cell_centred)
    for (const BoundarySpec& boundary : scene.boundaries)
      if (boundary.layers > 0) {
        const auto axis = static_cast<std::size_t>(axis_number(boundary.selection.on));
        options.layers[axis][boundary.selection.on.ends_with("_max")] = boundary.layers;
      }
  const Shape<D> shape = at_place(geometry.place, "geometry", [&] { return make_shape<D>(geometry); });
  return at_place(lattice.place, "lattice", [&] { return make_cloud<D>(shape, options); });
}

template <int D>
Simulation<D> build_simulation(const Scene& scene, const RunSpec& run, const SweepPoint& point) {
  Cloud<D> cloud = build_cloud<D>(scene, run, point);
  const Bounds<D> bounds = bounds_of(scene, run, point, cloud);
  const auto material = build_material<D>(material_of(scene, run, point));
  Simulation<D> simulation =
      at_place(run.place, "run", [&] { return Simulation<D>(std::move(cloud), material, run.method); });
  for (const RegionSpec& region : scene.regions) {
    const auto other = build_material<D>(material_of(scene, region, run, point));
    at_place(region.place, "region",
             [&] { simulation.set_material(where_of(region.selection, bounds, false), other); });
  }
  for (const BoundarySpec& boundary : scene.boundaries)
    at_place(boundary.place, "boundary", [&] { apply(simulation, boundary, bounds, run, point); });
  set_initial_state(simulation, scene, bounds);
  return simulation;
}

template <int D>
bool is_near_shape(const Scene& scene, const Vec<D>& X, double distance) {
  const Shape<D> shape = make_shape<D>(scene.geometry);
  // Rounding must not tell a point on the surface from one beyond it: half way out is tried as well.
  for (const double r : {0.0, 0.5 * distance, distance}) {
    Vec<D> offset;
    for (int k = 0; k < (D == 1 ? 3 : D == 2 ? 9 : 27); ++k) {
      for (int d = 0, digits = k; d < D; ++d, digits /= 3) offset[d] = digits % 3 - 1;
      if (offset.norm() > 0) offset.normalize();
      if (shape.contains(X + r * offset)) return true;
    }
  }
  return false;
}

#define TAUT_INSTANTIATE(D)                                                          \
  template bool is_near_shape<D>(const Scene&, const Vec<D>&, double);               \
  template Cloud<D> build_cloud<D>(const Scene&, const RunSpec&, const SweepPoint&); \
  template Simulation<D> build_simulation<D>(const Scene&, const RunSpec&, const SweepPoint&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut::bench
