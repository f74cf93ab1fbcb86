#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/base/powers.hpp>
#include <taut/formulations/assembly.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/formulations/registry.hpp>
#include <taut/geometry/local_origin.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/operators/operators.hpp>
#include <taut/particles/pair_rule.hpp>
#include <taut/simulation/input_checks.hpp>
#include <taut/simulation/rigid_modes.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

namespace {

/// Marks a call that is under way.
class Busy {
 public:
  Busy(const char*& busy, const char* what) : busy_(busy) { busy_ = what; }
  ~Busy() { busy_ = nullptr; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  const char*& busy_;
};

}  // namespace

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
std::size_t SimulationImpl<D>::known(std::size_t id) const {
  if (id >= cloud.size())
    throw InputError(fmt::format("particle {} is none of the {} of the cloud, which are numbered from 0", id,
                                 cloud.size()));
  return id;
}
template <int D>
void SimulationImpl<D>::must_be_idle(const char* what) const {
  if (busy)
    throw InputError(
        fmt::format("{}: not while the simulation is at {}, from a function that it calls. Ask the progress "
                    "call to stop the run, and go on when it has returned",
                    what, busy));
}
template <int D>
void SimulationImpl<D>::must_be_open(const char* what) const {
  must_be_idle(what);
  if (formulation)
    throw InputError(fmt::format("{}: set everything before the first run, relax or prepare", what));
}
template <int D>
std::vector<Index> SimulationImpl<D>::places(std::vector<Index> ids) const {
  if (particles.ties.empty()) {
    for (Index& i : ids) i = place(static_cast<std::size_t>(i));
    std::sort(ids.begin(), ids.end());
    return ids;
  }
  std::vector<bool> wanted(cloud.size(), false);
  for (const Index id : ids) wanted[static_cast<std::size_t>(id)] = true;
  std::vector<Index> all;
  for (Index i = 0; i < particles.n; ++i)
    if (wanted[static_cast<std::size_t>(particles.id[static_cast<std::size_t>(i)])]) all.push_back(i);
  return all;
}
template <int D>
const Interfaces<D>* SimulationImpl<D>::met() const {
  return interfaces && interfaces->resolved() &&
                 formulation_traits(method.formulation).materials != MaterialsMeet::in_particles
             ? interfaces.get()
             : nullptr;
}

template <int D>
Simulation<D>::Simulation(Cloud<D> cloud, std::shared_ptr<const Material<D>> material, Method method)
    : impl_(std::make_shared<SimulationImpl<D>>()) {
  if (!material) throw InputError("a simulation needs a material");
  check_cloud(cloud);
  check_values(method);
  method = checked_method(complete(method, cloud, *material));
  // What the method has no use for.
  if (!needs_areas(method)) cloud.facets = {};
  if (formulation_traits(method.formulation).materials != MaterialsMeet::in_cells) {
    cloud.cells = {};
    cloud.cell_share = {};
  }
  impl().material.assign(cloud.size(), 0);
  impl().cloud = std::move(cloud);
  make_local(impl().cloud);
  impl().materials.push_back(std::move(material));
  impl().method = std::move(method);
}
template <int D>
Simulation<D>::~Simulation() = default;
template <int D>
Simulation<D>::Simulation(Simulation&&) noexcept = default;
template <int D>
Simulation<D>& Simulation<D>::operator=(Simulation&&) noexcept = default;
template <int D>
SimulationImpl<D>& Simulation<D>::impl() const {
  if (!impl_)
    throw InputError("this simulation has been moved from: it is empty, and another one has its body");
  return *impl_;
}

template <int D>
Where<D> Simulation<D>::face(std::string_view name) const {
  return impl().cloud.facets.empty() ? on_face<D>(impl().cloud, name) : on_facets<D>(impl().cloud, name);
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

template <int D>
void Simulation<D>::observe(double interval, std::function<void(double)> f) {
  if (!(interval >= 0) || !std::isfinite(interval))
    throw InputError(fmt::format("observe: the interval {:g} s must not be negative", interval));
  must_be_callable("observe", "observer", f);
  impl().observers.push_back({interval, 0, std::move(f)});
}

namespace {

// Closed boundaries, for operators that need them: found where nothing is known of them, made of area vectors
// where these are all there is. Areas that have to be bent too far are an error.
template <int D>
void enclose(Cloud<D>& cloud) {
  if (cloud.facets.empty()) {
    if (cloud.B.empty()) return enclose_cloud(cloud);
    // A lattice's lie on the boundary with its particles.
    if (!cloud.body) place_areas(cloud);
  }
  constexpr double tolerable = 0.2;
  const double change = close_areas(cloud);
  if (!(change < tolerable))
    throw InputError(fmt::format(
        "the boundary area vectors do not enclose the body: closing them (sum B = 0, sum X (x) B = "
        "volume) would change them by {:.0f} %. Check their signs and the volumes, or leave them out",
        100 * change));
}

// The body goes on across a symmetry plane or the end of a period: what ends there is no boundary.
template <int D>
void open_facets_on(const std::vector<typename MirrorMap<D>::Plane>& planes,
                    const std::vector<typename MirrorMap<D>::Period>& periods, Cloud<D>& cloud) {
  for (const auto& period : periods)
    for (Facet<D>& f : cloud.facets) {
      const double in = f.centre[period.axis] - period.low;
      if (std::min(in, period.length - in) < 1e-6 * cloud.dx) f.area.setZero();
    }
  for (const auto& plane : planes)
    for (Facet<D>& f : cloud.facets)
      if ((f.centre[plane.axis] - plane.at) * (plane.side == 0 ? -1 : 1) > -1e-6 * cloud.dx) f.area.setZero();
}

}  // namespace

// Facets become areas of particles, by the same weights that carry tractions and walls.
template <int D>
void SimulationImpl<D>::place_facets() {
  facet_rows = FacetRows<D>(cloud.facets, particles, find_pairs_at_rest(particles, method));
  particles.B.assign(cloud.size(), Vec<D>::Zero());
  for (std::size_t f = 0; f < cloud.facets.size(); ++f)
    facet_rows.spread(f, cloud.facets[f].area, particles,
                      [&](Index i, const Vec<D>& part) { particles.B[static_cast<std::size_t>(i)] += part; });
}

namespace {
template <int D>
void check_wave_speed(const Material<D>& material) {
  for (const double speed : {material.wave_speed(), material.wave_speed(1, 1, 1, 1)}) {
    if (speed > 0 && std::isfinite(speed)) continue;
    throw InputError(
        fmt::format("material \"{}\" has the wave speed {:g} m/s, which must be positive and finite: "
                    "check its modulus and its density of {:g}",
                    material.name(), speed, material.density()));
  }
}

template <int D>
void build(SimulationImpl<D>& s) {
  const auto start = std::chrono::steady_clock::now();
  const bool areas_known = !s.cloud.B.empty() || !s.cloud.facets.empty();
  const Interfaces<D>* interfaces = s.met();
  const FormulationTraits& traits = formulation_traits(s.method.formulation);
  if (interfaces) interfaces->straighten(s.cloud);
  if (needs_areas(s.method) && s.planes.empty() && s.periods.empty()) enclose(s.cloud);
  open_facets_on<D>(s.planes, s.periods, s.cloud);
  const double widest = s.cloud.spacing.empty()
                            ? s.cloud.dx
                            : *std::max_element(s.cloud.spacing.begin(), s.cloud.spacing.end());
  const double reach = s.method.support_dx * widest * (1 + s.method.skin);
  for (const auto& material : s.materials) check_wave_speed(*material);
  const bool twins = interfaces && traits.materials == MaterialsMeet::in_twins;
  s.particles =
      assemble<D>(s.cloud, s.materials, s.material,
                  {s.planes, s.periods, reach, traits.reference == Reference::updated}, interfaces, twins);
  // Areas that are guesses tell nothing. Forms that find their neighbours anew let bodies meet.
  if (traits.reference == Reference::total && (areas_known || s.cloud.body))
    s.particles.rule = PairRule<D>::make(s.cloud, s.particles, s.planes, twins ? interfaces : nullptr, reach);
  if (!s.cloud.facets.empty()) s.place_facets();
  s.cloud.cells = {};  // the particles have them now
  s.cloud.cell_share = {};
  for (const auto& condition : s.conditions) condition();
  for (const auto& plane : s.planes) {
    std::vector<Index> on;
    for (Index i = 0; i < s.particles.n; ++i)
      if (std::abs(s.particles.X.component(plane.axis)[i] - plane.at) < 1e-6 * s.cloud.dx) on.push_back(i);
    if (!on.empty()) s.constraints.fix(std::move(on), plane.axis);
  }
  s.constraints.finish(s.particles.m);
  if (s.initial_displacement)
    for (Index i = 0; i < s.particles.n; ++i)
      s.particles.u.template set_vec<D>(i, s.initial_displacement(s.particles.reference_position(i)));
  if (!s.particles.mirror.empty()) s.particles.mirror.vectors(s.particles.u);
  auto formulation = make_formulation<D>({s.particles, s.constraints, s.loads, s.method});
  const double step = stable_step(leapfrog_limits, formulation->fastest());
  if (!(step > 0) || !std::isfinite(step))
    throw InputError(fmt::format(
        "the stable step of the body at rest is {:g} s: the highest frequency of its particles has no "
        "number. Check the material, spacing and volumes (and their units), zero_energy_control, and "
        "whether particles have neighbours at all",
        step));
  s.health = s.health_of_setup = setup_health<D>(s, *formulation);
  s.formulation = std::move(formulation);
  // A form on cells has taken them over.
  s.particles.cells = {};
  s.particles.cell_share = {};
  if (s.initial_velocity)
    for (Index i = 0; i < s.particles.n; ++i)
      s.particles.v.template set_vec<D>(i, s.initial_velocity(s.particles.reference_position(i)));
  s.setup_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}
}  // namespace

// All or nothing: what a build has changed when it throws is undone.
template <int D>
void Simulation<D>::prepare() {
  const auto alive = impl_;
  SimulationImpl<D>& s = impl();
  s.must_be_idle("prepare");
  if (s.formulation) return;
  const Busy busy(s.busy, "prepare");
  SimulationInput<D> before = s;
  try {
    build(s);
  } catch (...) {
    s.formulation.reset();
    static_cast<SimulationBuilt<D>&>(s) = SimulationBuilt<D>{};
    static_cast<SimulationInput<D>&>(s) = std::move(before);
    throw;
  }
}

template <int D>
template <class Loop>
RunResult SimulationImpl<D>::guarded(const char* what, Loop&& loop) {
  if (!lost.empty()) throw RunError(fmt::format("{}: {}", what, lost));
  const Busy now(busy, what);
  try {
    return loop();
  } catch (const std::exception& error) {
    recover(error.what());
    throw;
  } catch (...) {
    recover("an exception that is no std::exception");
    throw;
  }
}

template <int D>
void SimulationImpl<D>::recover(const char* error) {
  if (mid_step)
    lost = fmt::format(
        "the simulation cannot go on: the step after t = {:g} s ended half way with an error ({}). Its state "
        "can be looked at; make another one to go on",
        time, error);
  mid_step = false;
}

template <int D>
void Simulation<D>::check_run(double duration, const RunOptions& options) {
  impl().must_be_idle("run");
  check_options(duration, options);
  const StepLimits limits = make_integrator(options.integrator)->limits();
  prepare();
  if (impl().formulation->failure()) return;
  const double end = impl().time + duration;
  const double bound = options.cfl * stable_step(limits, impl().formulation->fastest());
  const double step = options.max_step > 0 ? std::min(bound, options.max_step) : bound;
  if (duration > 0 && !advances(end, step))
    throw InputError(
        fmt::format("run: steps of {:g} s never reach {:g} s, which has a resolution of {:g} s. Shorten "
                    "the duration, or enlarge max_step or cfl",
                    step, end, end - std::nextafter(end, 0)));
}

template <int D>
RunResult Simulation<D>::run(double duration, const RunOptions& options) {
  check_run(duration, options);
  const auto alive = impl_;
  return alive->guarded("run", [&] { return integrate(*alive, duration, options); });
}

template <int D>
void Simulation<D>::check_relax(const RelaxOptions& options) {
  impl().must_be_idle("relax");
  check_options(options);
  prepare();
  const SimulationImpl<D>& s = impl();
  if (s.formulation->failure() || s.loads.empty()) return;
  const std::vector<double> times = relaxation_times(s, options);
  require_held<D>({s.particles, s.formulation->bodies(), s.constraints, s.loads, s.planes, s.periods,
                   s.method.support_dx * s.cloud.dx, times});
}

template <int D>
RunResult Simulation<D>::relax(const RelaxOptions& options) {
  check_relax(options);
  const auto alive = impl_;
  return alive->guarded("relax", [&] { return find_equilibrium(*alive, options); });
}

template <int D>
std::size_t Simulation<D>::size() const {
  return impl().cloud.size();
}
template <int D>
double Simulation<D>::dx() const {
  return impl().cloud.dx;
}
template <int D>
double Simulation<D>::time() const {
  return impl().time;
}
template <int D>
const Method& Simulation<D>::method() const {
  return impl().method;
}
template <int D>
double Simulation<D>::setup_seconds() const {
  return impl().setup_seconds;
}
template <int D>
Vec<D> Simulation<D>::reference_position(std::size_t id) const {
  return impl().reference_position(id);
}

template <int D>
Vec<D> Simulation<D>::position(std::size_t id) const {
  return impl().cloud.origin + (impl().cloud.X[impl().known(id)] + displacement(id));
}
template <int D>
Vec<D> Simulation<D>::displacement(std::size_t id) const {
  impl().known(id);
  if (!impl().formulation) return Vec<D>::Zero();
  return impl().particles.u.template vec<D>(static_cast<std::size_t>(impl().place(id)));
}

namespace {
template <class Impl>
auto& prepared(const Impl& impl) {
  if (!impl.formulation) throw InputError("this is known only after prepare, run or relax");
  return *impl.formulation;
}
}  // namespace

template <int D>
Vec<D> Simulation<D>::velocity(std::size_t id) const {
  prepared(impl());
  impl().look();
  return impl().particles.v.template vec<D>(impl().place(id));
}
template <int D>
Vec<D> Simulation<D>::acceleration(std::size_t id) const {
  prepared(impl());
  return impl().particles.a.template vec<D>(impl().place(id));
}
template <int D>
const Health& Simulation<D>::health() const {
  prepared(impl());
  return impl().health;
}
template <int D>
Mat<D> Simulation<D>::cauchy_stress(std::size_t id) const {
  return prepared(impl()).cauchy_stress(impl().place(id));
}
template <int D>
Mat<3> Simulation<D>::full_cauchy_stress(std::size_t id) const {
  const Index i = impl().place(id);
  const Mat<3> sigma = prepared(impl()).full_cauchy_stress(i);
  const bool known = sigma.template topLeftCorner<D, D>().allFinite();
  const Material<D>& material = *impl().materials[impl().material[id]];
  for (int k = D; k < 3; ++k)
    if (known && std::isnan(sigma(k, k)))
      throw InputError(
          fmt::format("the stress along {} is not known: material \"{}\" does not give it "
                      "(Hyperelastic::has_lateral_state), or formulation \"{}\" does not "
                      "(Formulation::full_cauchy_stress)",
                      "xyz"[k], material.name(), method().formulation));
  return sigma;
}
template <int D>
Mat<D> Simulation<D>::first_piola_kirchhoff(std::size_t id) const {
  return prepared(impl()).first_piola_kirchhoff(impl().place(id));
}
template <int D>
Mat<D> Simulation<D>::deformation_gradient(std::size_t id) const {
  return prepared(impl()).deformation_gradient(impl().place(id));
}
template <int D>
double Simulation<D>::mass(std::size_t id) const {
  const double V = impl().cloud.V[impl().known(id)];
  const Interfaces<D>* interfaces = impl().met();
  if (!interfaces) return V * impl().materials[impl().material[id]]->density();
  double mass = 0;
  for (const auto& part : interfaces->parts(id)) mass += part.V * impl().materials[part.material]->density();
  return mass;
}

template <int D>
double Simulation<D>::kinetic_energy() const {
  double energy = 0;
  for (std::size_t i = 0; i < size(); ++i) energy += 0.5 * mass(i) * velocity(i).squaredNorm();
  return energy;
}
template <int D>
double Simulation<D>::strain_energy() const {
  return prepared(impl()).strain_energy();
}
template <int D>
Vec<D> Simulation<D>::linear_momentum() const {
  Vec<D> momentum = Vec<D>::Zero();
  for (std::size_t i = 0; i < size(); ++i) momentum += mass(i) * velocity(i);
  return momentum;
}
template <int D>
std::int64_t Simulation<D>::pairs() const {
  return prepared(impl()).pairs();
}
template <int D>
std::size_t Simulation<D>::bytes() const {
  return prepared(impl()).bytes() + prepared(impl()).own_bytes() + impl().particles.bytes() +
         (impl().integrator ? impl().integrator->bytes() : 0);
}

template class Simulation<1>;
template class Simulation<2>;
template class Simulation<3>;

}  // namespace taut
