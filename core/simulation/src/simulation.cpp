#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/formulations/registry.hpp>
#include <taut/geometry/local_origin.hpp>
#include <taut/integrators/integrator.hpp>
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
void Simulation<D>::observe(double interval, std::function<void(double)> f) {
  if (!(interval >= 0) || !std::isfinite(interval))
    throw InputError(fmt::format("observe: the interval {:g} s must not be negative", interval));
  must_be_callable("observe", "observer", f);
  impl().observers.push_back({interval, 0, std::move(f)});
}

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

#define TAUT_INSTANTIATE(D)                                                        \
  template class Simulation<D>;                                                    \
  template std::size_t SimulationImpl<D>::known(std::size_t) const;                \
  template void SimulationImpl<D>::must_be_open(const char*) const;                \
  template std::vector<Index> SimulationImpl<D>::places(std::vector<Index>) const; \
  template const Interfaces<D>* SimulationImpl<D>::met() const;
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
