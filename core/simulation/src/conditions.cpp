#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/formulations/assembly.hpp>
#include <taut/geometry/local_origin.hpp>
#include <taut/simulation/input_checks.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

template <int D>
std::vector<Index> SimulationImpl<D>::select_particles(const Where<D>& where, const char* what) const {
  must_be_open(what);
  must_be_callable(what, "predicate", where);
  std::vector<Index> ids;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (where(reference_position(i))) ids.push_back(static_cast<Index>(i));
  return ids;
}
template <int D>
auto SimulationImpl<D>::select(const Where<D>& where, const char* what) const -> Selected {
  Selected selected{select_particles(where, what), {}};
  std::vector<char> chosen(cloud.facets.empty() ? 0 : cloud.size(), 0);
  if (!chosen.empty())
    for (const Index i : selected.particles) chosen[static_cast<std::size_t>(i)] = 1;
  for (std::size_t f = 0; f < cloud.facets.size(); ++f)
    if (!chosen[static_cast<std::size_t>(cloud.facets[f].owner)] &&
        where(cloud.origin + cloud.facets[f].centre))
      selected.facets.push_back(static_cast<Index>(f));
  if (selected.particles.empty() && selected.facets.empty())
    throw InputError(fmt::format("{} selects no particle", what));
  return selected;
}

template <int D>
void Simulation<D>::set_material(const Where<D>& where, std::shared_ptr<const Material<D>> material) {
  if (!material) throw InputError("set_material: no material");
  if (impl().materials.size() == 255) throw InputError("set_material: at most 255 materials");
  const auto number = static_cast<std::uint8_t>(impl().materials.size());
  const std::vector<Index> ids = impl().select_particles(where, "set_material");
  if (ids.empty()) throw InputError("set_material selects no particle");
  std::shared_ptr<Interfaces<D>> interfaces;
  if (impl().interfaces)
    interfaces = std::make_shared<Interfaces<D>>(*impl().interfaces);
  else if (Interfaces<D>::known(impl().cloud))
    interfaces = std::make_shared<Interfaces<D>>(impl().cloud);
  if (interfaces) interfaces->assign(impl().cloud, where, number);
  impl().materials.push_back(std::move(material));
  for (const Index i : ids) impl().material[static_cast<std::size_t>(i)] = number;
  impl().interfaces = std::move(interfaces);
}

template <int D>
void Simulation<D>::set_velocity(const std::function<Vec<D>(const Vec<D>&)>& velocity) {
  impl().must_be_open("set_velocity");
  must_be_callable("set_velocity", "velocity", velocity);
  impl().initial_velocity = velocity;
}

template <int D>
void Simulation<D>::set_displacement(const std::function<Vec<D>(const Vec<D>&)>& displacement) {
  impl().must_be_open("set_displacement");
  must_be_callable("set_displacement", "displacement", displacement);
  impl().initial_displacement = displacement;
}

template <int D>
void Simulation<D>::clamp(const Where<D>& where) {
  impl().conditions.push_back([impl = &impl(), selected = impl().select(where, "clamp")] {
    for (int d = 0; d < D; ++d) impl->hold(selected, d, {});
  });
}

template <int D>
void Simulation<D>::roller(const Where<D>& where, int axis) {
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("roller: axis {} is not one of 0 … {}", axis, D - 1));
  impl().conditions.push_back(
      [impl = &impl(), axis, selected = impl().select(where, "roller")] { impl->hold(selected, axis, {}); });
}

template <int D>
void SimulationImpl<D>::prescribe(const Where<D>& where, int axis, PrescribedMotion<D> motion) {
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("prescribe: axis {} is not one of 0 … {}", axis, D - 1));
  // Conditions know the user's coordinates.
  this->conditions.push_back([this, axis, selected = select(where, "prescribe"),
                              local = motion.seen_from(cloud.origin)] { hold(selected, axis, local); });
}
template <int D>
void Simulation<D>::prescribe(const Where<D>& where, int axis, PointHistory<D> displacement,
                              PointHistory<D> velocity) {
  must_be_callable("prescribe", "displacement", displacement);
  impl().prescribe(where, axis, {std::move(displacement), std::move(velocity)});
}
template <int D>
void Simulation<D>::prescribe(const Where<D>& where, int axis, History displacement, History velocity) {
  must_be_callable("prescribe", "displacement", displacement);
  impl().prescribe(where, axis, {std::move(displacement), std::move(velocity)});
}

template <int D>
void SimulationImpl<D>::hold(const Selected& selected, int axis, const PrescribedMotion<D>& motion) {
  if (!selected.particles.empty()) constraints.prescribe(places(selected.particles), axis, motion);
  std::vector<BoundPoint<D>> points;
  for (const Index f : selected.facets) {
    BoundPoint<D> point{cloud.facets[static_cast<std::size_t>(f)].centre, {}, f};
    for (const auto& term : facet_rows.row(static_cast<std::size_t>(f)))
      point.terms.push_back({term.particle, (term.flips >> axis & 1) ? -term.weight : term.weight});
    points.push_back(std::move(point));
  }
  if (!points.empty()) constraints.hold(std::move(points), axis, motion);
}

template <int D>
void Simulation<D>::load(const Where<D>& where, const Vec<D>& force, History history) {
  if (!force.allFinite()) throw InputError("load: the force is not finite");
  impl().conditions.push_back([impl = &impl(), selected = impl().select(where, "load"), force,
                               history = std::move(history)] { impl->add_load(selected, force, history); });
}

namespace {

// The part of each area along their mean normal; empty where that is nothing, as all around a body.
template <int D, class Area>
std::vector<double> facing_weights(std::size_t count, Area&& area) {
  Vec<D> normal = Vec<D>::Zero();
  double total = 0, sum = 0;
  for (std::size_t k = 0; k < count; ++k) {
    normal += area(k);
    total += area(k).norm();
  }
  if (!(normal.norm() > 1e-12 * total)) return {};
  normal.normalize();
  std::vector<double> weight(count);
  for (std::size_t k = 0; k < count; ++k) sum += weight[k] = std::max(0.0, normal.dot(area(k)));
  for (double& w : weight) w /= sum;
  return weight;
}

}  // namespace

// On the facets selected and those of the particles selected; false where there are none.
template <int D>
bool SimulationImpl<D>::add_traction(const Selected& selected, const Vec<D>& force, const History& history) {
  std::vector<Index> facets = selected.facets;
  std::vector<char> chosen(cloud.size(), 0);
  for (const Index i : selected.particles) chosen[static_cast<std::size_t>(i)] = 1;
  for (std::size_t f = 0; f < cloud.facets.size(); ++f)
    if (chosen[static_cast<std::size_t>(cloud.facets[f].owner)]) facets.push_back(static_cast<Index>(f));
  const auto weight = facing_weights<D>(
      facets.size(), [&](std::size_t k) { return cloud.facets[static_cast<std::size_t>(facets[k])].area; });
  if (weight.empty()) return false;
  std::vector<Index> at;
  std::vector<Vec<D>> forces;
  for (std::size_t k = 0; k < facets.size(); ++k)
    if (weight[k] > 0)
      facet_rows.spread(static_cast<std::size_t>(facets[k]), weight[k] * force, particles,
                        [&](Index particle, const Vec<D>& part) {
                          at.push_back(particle);
                          forces.push_back(part);
                        });
  loads.add(std::move(at), std::move(forces), history);
  return true;
}

template <int D>
void SimulationImpl<D>::add_load(const Selected& selected, const Vec<D>& force, History history) {
  if (!cloud.facets.empty() && add_traction(selected, force, history)) return;
  const std::vector<Index>& ids = selected.particles;
  std::vector<double> weight;
  if (!cloud.B.empty())
    weight = facing_weights<D>(ids.size(),
                               [&](std::size_t k) { return cloud.B[static_cast<std::size_t>(ids[k])]; });
  if (weight.empty()) weight.assign(ids.size(), 1.0 / static_cast<double>(ids.size()));
  // A particle on a symmetry plane carries its image's load as well.
  const auto times = multiplicity<D>(cloud, planes);
  std::vector<Index> at;
  std::vector<Vec<D>> forces;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    if (weight[k] == 0) continue;
    const auto id = static_cast<std::size_t>(ids[k]);
    at.push_back(place(id));
    forces.push_back(force * (weight[k] * times[id]));
  }
  loads.add(std::move(at), std::move(forces), std::move(history));
}

template <int D>
void Simulation<D>::body_force(const Vec<D>& acceleration, History history) {
  impl().must_be_open("body_force");
  if (!acceleration.allFinite()) throw InputError("body_force: the acceleration is not finite");
  impl().conditions.push_back([impl = &impl(), acceleration, history = std::move(history)] {
    impl->loads.add_body_force(impl->particles.n, acceleration, history);
  });
}

template <int D>
void Simulation<D>::symmetry_plane(int axis, double at) {
  impl().must_be_open("symmetry_plane");
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("symmetry_plane: axis {} is not one of 0 … {}", axis, D - 1));
  if (!std::isfinite(at)) throw InputError(fmt::format("symmetry_plane: {:g} m is no place for a plane", at));
  const Cloud<D>& cloud = impl().cloud;
  for (const auto& period : impl().periods)
    if (period.axis == axis)
      throw InputError(fmt::format("symmetry_plane: the axis {} is periodic", "xyz"[axis]));
  double local = coordinate_difference(at, cloud.origin[axis]), sum = 0;
  for (const Vec<D>& X : cloud.X) sum += X[axis] - local;
  // Particles that are on the plane but for the rounding of its coordinate are on the plane.
  if (cloud.origin[axis] != 0)
    for (const Vec<D>& X : cloud.X)
      if (std::abs(X[axis] - local) <= coordinate_rounding(at)) local = X[axis];
  for (const auto& plane : impl().planes)
    if (plane.axis == axis && std::abs(plane.at - local) < 1e-3 * cloud.dx)
      throw InputError(fmt::format(
          "symmetry_plane: there is one across {} at {:g} m already, and a body has one image beyond it",
          "xyz"[axis], at));
  impl().planes.push_back({axis, local, sum > 0 ? 0 : 1});
}

template <int D>
void Simulation<D>::periodic(int axis, double low, double high) {
  impl().must_be_open("periodic");
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("periodic: axis {} is not one of 0 … {}", axis, D - 1));
  if (!(high > low) || !std::isfinite(high - low))
    throw InputError(fmt::format("periodic: the end {:g} must be above the beginning {:g}", high, low));
  const auto same = [axis](const auto& other) { return other.axis == axis; };
  if (std::any_of(impl().planes.begin(), impl().planes.end(), same) ||
      std::any_of(impl().periods.begin(), impl().periods.end(), same))
    throw InputError(
        fmt::format("periodic: the axis {} has a symmetry plane or a period already", "xyz"[axis]));
  impl().periods.push_back({axis, coordinate_difference(low, impl().cloud.origin[axis]), high - low});
}

#define TAUT_INSTANTIATE(D)                                                                       \
  template void Simulation<D>::set_material(const Where<D>&, std::shared_ptr<const Material<D>>); \
  template void Simulation<D>::set_velocity(const std::function<Vec<D>(const Vec<D>&)>&);         \
  template void Simulation<D>::set_displacement(const std::function<Vec<D>(const Vec<D>&)>&);     \
  template void Simulation<D>::clamp(const Where<D>&);                                            \
  template void Simulation<D>::roller(const Where<D>&, int);                                      \
  template void Simulation<D>::prescribe(const Where<D>&, int, PointHistory<D>, PointHistory<D>); \
  template void Simulation<D>::prescribe(const Where<D>&, int, History, History);                 \
  template void Simulation<D>::load(const Where<D>&, const Vec<D>&, History);                     \
  template void Simulation<D>::body_force(const Vec<D>&, History);                                \
  template void Simulation<D>::symmetry_plane(int, double);                                       \
  template void Simulation<D>::periodic(int, double, double);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
