#include <fmt/format.h>

#include <Eigen/Dense>
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
#include <taut/simulation/rigid_modes.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

template <int D>
std::vector<Index> SimulationImpl<D>::select_particles(const Where<D>& where, const char* what) const {
  must_be_open(what);
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
void SimulationImpl<D>::must_be_open(const char* what) const {
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
    : impl_(std::make_unique<SimulationImpl<D>>()) {
  if (!material) throw InputError("a simulation needs a material");
  method = checked_method(complete(method, cloud, *material));
  if (cloud.size() == 0) throw InputError("the body has no particles");
  if (!(cloud.dx > 0) || !std::isfinite(cloud.dx))
    throw InputError(fmt::format("the cloud's spacing dx = {:g} must be positive", cloud.dx));
  if (cloud.V.size() != cloud.size())
    throw InputError(fmt::format("the cloud has {} positions but {} volumes", cloud.size(), cloud.V.size()));
  if (!cloud.spacing.empty() && cloud.spacing.size() != cloud.size())
    throw InputError(
        fmt::format("the cloud has {} positions but {} spacings", cloud.size(), cloud.spacing.size()));
  for (const double spacing : cloud.spacing)
    if (!(spacing > 0) || !std::isfinite(spacing))
      throw InputError(fmt::format("the cloud's spacings must be positive; one is {:g}", spacing));
  if (!cloud.B.empty() && cloud.B.size() != cloud.size())
    throw InputError(
        fmt::format("the cloud has {} positions but {} boundary area vectors", cloud.size(), cloud.B.size()));
  for (std::size_t q = 0; q < cloud.cells.size(); ++q)
    for (const Index corner : cloud.cells[q])
      if (corner < 0 || static_cast<std::size_t>(corner) >= cloud.size())
        throw InputError(
            fmt::format("corner {} of cell {} is none of the {} particles", corner, q, cloud.size()));
  if (!cloud.cell_share.empty() && cloud.cell_share.size() != cloud.cells.size())
    throw InputError(fmt::format("the cloud has {} cells but {} shares of them", cloud.cells.size(),
                                 cloud.cell_share.size()));
  for (const Facet<D>& facet : cloud.facets)
    if (facet.owner < 0 || static_cast<std::size_t>(facet.owner) >= cloud.size())
      throw InputError(
          fmt::format("the owner {} of a facet is none of the {} particles", facet.owner, cloud.size()));
  // What the method has no use for.
  if (!needs_areas(method)) cloud.facets = {};
  if (formulation_traits(method.formulation).materials != MaterialsMeet::in_cells) {
    cloud.cells = {};
    cloud.cell_share = {};
  }
  impl_->material.assign(cloud.size(), 0);
  impl_->cloud = std::move(cloud);
  make_local(impl_->cloud);
  impl_->materials.push_back(std::move(material));
  impl_->method = std::move(method);
}
template <int D>
Simulation<D>::~Simulation() = default;
template <int D>
Simulation<D>::Simulation(Simulation&&) noexcept = default;

template <int D>
Where<D> Simulation<D>::face(std::string_view name) const {
  return impl_->cloud.facets.empty() ? on_face<D>(impl_->cloud, name) : on_facets<D>(impl_->cloud, name);
}

template <int D>
void Simulation<D>::set_material(const Where<D>& where, std::shared_ptr<const Material<D>> material) {
  if (!material) throw InputError("set_material: no material");
  if (impl_->materials.size() == 255) throw InputError("set_material: at most 255 materials");
  const auto number = static_cast<std::uint8_t>(impl_->materials.size());
  const std::vector<Index> ids = impl_->select_particles(where, "set_material");
  if (ids.empty()) throw InputError("set_material selects no particle");
  for (const Index i : ids) impl_->material[static_cast<std::size_t>(i)] = number;
  if (!impl_->interfaces && Interfaces<D>::known(impl_->cloud))
    impl_->interfaces = std::make_unique<Interfaces<D>>(impl_->cloud);
  if (impl_->interfaces) impl_->interfaces->assign(impl_->cloud, where, number);
  impl_->materials.push_back(std::move(material));
}

template <int D>
void Simulation<D>::set_velocity(const std::function<Vec<D>(const Vec<D>&)>& velocity) {
  impl_->must_be_open("set_velocity");
  impl_->initial_velocity = velocity;
}

template <int D>
void Simulation<D>::set_displacement(const std::function<Vec<D>(const Vec<D>&)>& displacement) {
  impl_->must_be_open("set_displacement");
  impl_->initial_displacement = displacement;
}

template <int D>
void Simulation<D>::clamp(const Where<D>& where) {
  impl_->conditions.push_back([impl = impl_.get(), selected = impl_->select(where, "clamp")] {
    for (int d = 0; d < D; ++d) impl->hold(selected, d, {});
  });
}

template <int D>
void Simulation<D>::roller(const Where<D>& where, int axis) {
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("roller: axis {} is not one of 0 … {}", axis, D - 1));
  impl_->conditions.push_back([impl = impl_.get(), axis, selected = impl_->select(where, "roller")] {
    impl->hold(selected, axis, {});
  });
}

template <int D>
void Simulation<D>::prescribe(const Where<D>& where, int axis,
                              std::function<double(const Vec<D>&, double)> displacement) {
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("prescribe: axis {} is not one of 0 … {}", axis, D - 1));
  impl_->conditions.push_back([impl = impl_.get(), axis, selected = impl_->select(where, "prescribe"),
                               f = std::move(displacement)] { impl->hold(selected, axis, f); });
}

template <int D>
void SimulationImpl<D>::hold(const Selected& selected, int axis,
                             typename Constraints<D>::Displacement displacement) {
  // Conditions know the user's coordinates.
  if (displacement)
    displacement = [f = std::move(displacement), origin = cloud.origin](const Vec<D>& X, double t) {
      return f(origin + X, t);
    };
  if (!selected.particles.empty()) {
    if (displacement)
      constraints.prescribe(places(selected.particles), axis, displacement);
    else
      constraints.fix(places(selected.particles), axis);
  }
  std::vector<BoundPoint<D>> points;
  for (const Index f : selected.facets) {
    BoundPoint<D> point{cloud.facets[static_cast<std::size_t>(f)].centre, {}, f};
    for (const auto& term : facet_rows.row(static_cast<std::size_t>(f)))
      point.terms.push_back({term.particle, (term.flips >> axis & 1) ? -term.weight : term.weight});
    points.push_back(std::move(point));
  }
  if (!points.empty()) constraints.hold(std::move(points), axis, std::move(displacement));
}

template <int D>
void Simulation<D>::load(const Where<D>& where, const Vec<D>& force, History history) {
  if (!force.allFinite()) throw InputError("load: the force is not finite");
  impl_->conditions.push_back([impl = impl_.get(), selected = impl_->select(where, "load"), force,
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
  impl_->must_be_open("body_force");
  if (!acceleration.allFinite()) throw InputError("body_force: the acceleration is not finite");
  impl_->conditions.push_back([impl = impl_.get(), acceleration, history = std::move(history)] {
    impl->loads.add_body_force(impl->particles.n, acceleration, history);
  });
}

template <int D>
void Simulation<D>::symmetry_plane(int axis, double at) {
  impl_->must_be_open("symmetry_plane");
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("symmetry_plane: axis {} is not one of 0 … {}", axis, D - 1));
  const Cloud<D>& cloud = impl_->cloud;
  double local = coordinate_difference(at, cloud.origin[axis]), sum = 0;
  for (const Vec<D>& X : cloud.X) sum += X[axis] - local;
  // Particles that are on the plane but for the rounding of its coordinate are on the plane.
  if (cloud.origin[axis] != 0)
    for (const Vec<D>& X : cloud.X)
      if (std::abs(X[axis] - local) <= coordinate_rounding(at)) local = X[axis];
  impl_->planes.push_back({axis, local, sum > 0 ? 0 : 1});
}

template <int D>
void Simulation<D>::observe(double interval, std::function<void(double)> f) {
  impl_->observers.push_back({interval, 0, std::move(f)});
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

// The body goes on across a symmetry plane: what ends there is no boundary.
template <int D>
void open_facets_on(const std::vector<typename MirrorMap<D>::Plane>& planes, Cloud<D>& cloud) {
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
  const double speed = material.wave_speed();
  if (!(speed > 0) || !std::isfinite(speed))
    throw InputError(
        fmt::format("material \"{}\" has the wave speed {:g} m/s, which must be positive and finite: "
                    "check its modulus and its density of {:g}",
                    material.name(), speed, material.density()));
}
}  // namespace

template <int D>
void Simulation<D>::prepare() {
  if (impl_->formulation) return;
  const auto start = std::chrono::steady_clock::now();
  SimulationImpl<D>& s = *impl_;
  const bool areas_known = !s.cloud.B.empty() || !s.cloud.facets.empty();
  const Interfaces<D>* interfaces = s.met();
  const FormulationTraits& traits = formulation_traits(s.method.formulation);
  if (interfaces) interfaces->straighten(s.cloud);
  if (needs_areas(s.method) && s.planes.empty()) enclose(s.cloud);
  open_facets_on<D>(s.planes, s.cloud);
  const double widest = s.cloud.spacing.empty()
                            ? s.cloud.dx
                            : *std::max_element(s.cloud.spacing.begin(), s.cloud.spacing.end());
  const double reach = s.method.support_dx * widest * (1 + s.method.skin);
  for (const auto& material : s.materials) check_wave_speed(*material);
  const bool twins = interfaces && traits.materials == MaterialsMeet::in_twins;
  s.particles = assemble<D>(s.cloud, s.materials, s.material, s.planes, reach, interfaces, twins);
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
  const double step = formulation->stable_step();
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

template <int D>
void Simulation<D>::check_run(double duration, const RunOptions& options) {
  if (!(duration >= 0) || !std::isfinite(duration))
    throw InputError(fmt::format("run: the duration {:g} s must not be negative", duration));
  if (!(options.cfl > 0) || !std::isfinite(options.cfl))
    throw InputError(fmt::format("run: cfl = {:g} must be positive and finite", options.cfl));
  make_integrator(options.integrator);
  prepare();
  if (impl_->formulation->failure()) return;
  const double end = impl_->time + duration;
  const double bound = options.cfl * impl_->formulation->stable_step();
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
  return integrate(*impl_, *make_integrator(options.integrator), duration, options);
}

template <int D>
void Simulation<D>::check_relax(const RelaxOptions& options) {
  if (!(options.tolerance > 0))
    throw InputError(fmt::format("relax: tolerance = {:g} must be positive", options.tolerance));
  if (!(options.cfl > 0) || !std::isfinite(options.cfl))
    throw InputError(fmt::format("relax: cfl = {:g} must be positive and finite", options.cfl));
  prepare();
  const SimulationImpl<D>& s = *impl_;
  if (s.formulation->failure() || s.loads.empty()) return;
  const std::vector<double> times = relaxation_times(s, options);
  require_held<D>({s.particles, s.formulation->bodies(), s.constraints, s.loads, s.planes,
                   s.method.support_dx * s.cloud.dx, times});
}

template <int D>
RunResult Simulation<D>::relax(const RelaxOptions& options) {
  check_relax(options);
  return find_equilibrium(*impl_, options);
}

template <int D>
std::size_t Simulation<D>::size() const {
  return impl_->cloud.size();
}
template <int D>
double Simulation<D>::dx() const {
  return impl_->cloud.dx;
}
template <int D>
double Simulation<D>::time() const {
  return impl_->time;
}
template <int D>
const Method& Simulation<D>::method() const {
  return impl_->method;
}
template <int D>
double Simulation<D>::setup_seconds() const {
  return impl_->setup_seconds;
}
template <int D>
Vec<D> Simulation<D>::reference_position(std::size_t id) const {
  return impl_->reference_position(id);
}

template <int D>
Vec<D> Simulation<D>::position(std::size_t id) const {
  return impl_->cloud.origin + (impl_->cloud.X.at(id) + displacement(id));
}
template <int D>
Vec<D> Simulation<D>::displacement(std::size_t id) const {
  if (!impl_->formulation) return Vec<D>::Zero();
  return impl_->particles.u.template vec<D>(static_cast<std::size_t>(impl_->place(id)));
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
  prepared(*impl_);
  impl_->look();
  return impl_->particles.v.template vec<D>(impl_->place(id));
}
template <int D>
const Health& Simulation<D>::health() const {
  prepared(*impl_);
  return impl_->health;
}
template <int D>
Mat<D> Simulation<D>::cauchy_stress(std::size_t id) const {
  return prepared(*impl_).cauchy_stress(impl_->place(id));
}
template <int D>
Mat<3> Simulation<D>::full_cauchy_stress(std::size_t id) const {
  const Index i = impl_->place(id);
  const Mat<3> sigma = prepared(*impl_).full_cauchy_stress(i);
  const bool known = sigma.template topLeftCorner<D, D>().allFinite();
  const Material<D>& material = *impl_->materials[impl_->material[id]];
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
  return prepared(*impl_).first_piola_kirchhoff(impl_->place(id));
}
template <int D>
Mat<D> Simulation<D>::deformation_gradient(std::size_t id) const {
  return prepared(*impl_).deformation_gradient(impl_->place(id));
}
template <int D>
double Simulation<D>::mass(std::size_t id) const {
  const double V = impl_->cloud.V.at(id);
  const Interfaces<D>* interfaces = impl_->met();
  if (!interfaces) return V * impl_->materials[impl_->material[id]]->density();
  double mass = 0;
  for (const auto& part : interfaces->parts(id)) mass += part.V * impl_->materials[part.material]->density();
  return mass;
}

template <int D>
Vec<D> Simulation<D>::displacement_at(const Vec<D>& X) const {
  // Nearest particles first, until a plane through them is well determined.
  const double dx = impl_->cloud.dx;
  const Vec<D> at = coordinate_difference<D>(X, impl_->cloud.origin);
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < size(); ++i) {
    const double r2 = (impl_->cloud.X[i] - at).squaredNorm();
    if (r2 < 9 * dx * dx) near.emplace_back(r2, i);
  }
  std::sort(near.begin(), near.end());
  if (near.empty()) throw InputError("displacement_at: no particle within three spacings of the point");
  const double same = std::max(1e-6 * dx, coordinate_rounding(X.norm()));
  if (near.front().first < same * same) return displacement(near.front().second);
  // Not across slits.
  if (const auto& rule = impl_->particles.rule)
    std::erase_if(near, [&, nearest = impl_->place(near.front().second)](const auto& other) {
      const Index i = impl_->place(other.second);
      return i != nearest && !rule->same_body(nearest, i);
    });
  Fixed<D + 1> normal = Fixed<D + 1>::Zero();
  Fixed<D + 1, D> right = Fixed<D + 1, D>::Zero();
  for (const auto& [r2, i] : near) {
    const double q2 = r2 / (9 * dx * dx);
    const double weight = (1 - q2) * (1 - q2) * (1 - q2) * (1 - q2) / (r2 / (dx * dx) + 0.05);
    Fixed<D + 1, 1> basis;
    basis << 1, (impl_->cloud.X[i] - at) / dx;
    normal += weight * basis * basis.transpose();
    right += weight * basis * displacement(i).transpose();
  }
  const Eigen::FullPivLU<Fixed<D + 1>> lu(normal);
  if (!lu.isInvertible()) return displacement(near.front().second);
  return lu.solve(right).row(0).transpose();
}

template <int D>
double Simulation<D>::kinetic_energy() const {
  double energy = 0;
  for (std::size_t i = 0; i < size(); ++i) energy += 0.5 * mass(i) * velocity(i).squaredNorm();
  return energy;
}
template <int D>
double Simulation<D>::strain_energy() const {
  return prepared(*impl_).strain_energy();
}
template <int D>
Vec<D> Simulation<D>::linear_momentum() const {
  Vec<D> momentum = Vec<D>::Zero();
  for (std::size_t i = 0; i < size(); ++i) momentum += mass(i) * velocity(i);
  return momentum;
}
template <int D>
std::int64_t Simulation<D>::pairs() const {
  return prepared(*impl_).pairs();
}
template <int D>
std::size_t Simulation<D>::bytes() const {
  return prepared(*impl_).bytes() + prepared(*impl_).own_bytes() + impl_->particles.bytes();
}

template class Simulation<1>;
template class Simulation<2>;
template class Simulation<3>;

}  // namespace taut
