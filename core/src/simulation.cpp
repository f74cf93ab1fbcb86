#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <taut/core/error.hpp>
#include <taut/core/kernel.hpp>
#include <taut/core/operators.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/internal/assembly.hpp>
#include <taut/internal/simulation_impl.hpp>
#include <taut/neighbors/search.hpp>

namespace taut {

namespace {

// Names are checked when they are given, not minutes later.
template <int D>
void check(const Method& method) {
  const auto one_of = [](const char* what, const std::string& name, const std::vector<std::string>& valid) {
    if (std::find(valid.begin(), valid.end(), name) == valid.end())
      throw InputError(fmt::format("unknown {} \"{}\"; valid: {}", what, name, join_names(valid)));
  };
  one_of("formulation", method.formulation, formulation_names());
  one_of("operators", method.operators, operator_names());
  one_of("kernel", method.kernel, Kernel::names());
  search_method(method.neighbours);
  if (!(method.support_dx > 1) || method.support_dx > 20)
    throw InputError(fmt::format("support_dx = {:g} must lie between 1 (nearest neighbours excluded) and 20",
                                 method.support_dx));
  const auto not_negative = [](const char* what, double value) {
    if (!(value >= 0) || !std::isfinite(value))
      throw InputError(fmt::format("{} = {:g} must not be negative", what, value));
  };
  not_negative("zero_energy_control", method.zero_energy_control.value_or(0));
  not_negative("viscosity", method.viscosity);
  not_negative("skin", method.skin);
}

}  // namespace

template <int D>
std::vector<Index> SimulationImpl<D>::select(const Where<D>& where, const char* what) const {
  must_be_open(what);
  std::vector<Index> ids;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (where(cloud.X[i])) ids.push_back(static_cast<Index>(i));
  if (ids.empty()) throw InputError(fmt::format("{} selects no particle", what));
  return ids;
}
template <int D>
void SimulationImpl<D>::must_be_open(const char* what) const {
  if (formulation)
    throw InputError(fmt::format("{}: set everything before the first run, relax or prepare", what));
}
template <int D>
std::vector<Index> SimulationImpl<D>::places(std::vector<Index> ids) const {
  for (Index& i : ids) i = place(static_cast<std::size_t>(i));
  std::sort(ids.begin(), ids.end());
  return ids;
}

template <int D>
Simulation<D>::Simulation(Cloud<D> cloud, std::shared_ptr<const Material<D>> material, Method method)
    : impl_(std::make_unique<SimulationImpl<D>>()) {
  check<D>(method);
  if (!material) throw InputError("a simulation needs a material");
  if (cloud.size() == 0) throw InputError("the body has no particles");
  if (!(cloud.dx > 0) || !std::isfinite(cloud.dx))
    throw InputError(fmt::format("the cloud's spacing dx = {:g} must be positive", cloud.dx));
  if (cloud.V.size() != cloud.size())
    throw InputError(fmt::format("the cloud has {} positions but {} volumes", cloud.size(), cloud.V.size()));
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
  impl_->material.assign(cloud.size(), 0);
  impl_->cloud = std::move(cloud);
  impl_->materials.push_back(std::move(material));
  impl_->method = std::move(method);
}
template <int D>
Simulation<D>::~Simulation() = default;
template <int D>
Simulation<D>::Simulation(Simulation&&) noexcept = default;

template <int D>
Where<D> Simulation<D>::face(std::string_view name) const {
  return on_face<D>(impl_->cloud, name);
}

template <int D>
void Simulation<D>::set_material(const Where<D>& where, std::shared_ptr<const Material<D>> material) {
  if (!material) throw InputError("set_material: no material");
  if (impl_->materials.size() == 255) throw InputError("set_material: at most 255 materials");
  for (const Index i : impl_->select(where, "set_material"))
    impl_->material[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(impl_->materials.size());
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
  const auto ids = impl_->select(where, "clamp");
  impl_->conditions.push_back([impl = impl_.get(), ids] {
    for (int d = 0; d < D; ++d) impl->constraints.fix(impl->places(ids), d);
  });
}

template <int D>
void Simulation<D>::roller(const Where<D>& where, int axis) {
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("roller: axis {} is not one of 0 … {}", axis, D - 1));
  impl_->conditions.push_back([impl = impl_.get(), axis, ids = impl_->select(where, "roller")] {
    impl->constraints.fix(impl->places(ids), axis);
  });
}

template <int D>
void Simulation<D>::prescribe(const Where<D>& where, int axis,
                              std::function<double(const Vec<D>&, double)> displacement) {
  if (axis < 0 || axis >= D)
    throw InputError(fmt::format("prescribe: axis {} is not one of 0 … {}", axis, D - 1));
  impl_->conditions.push_back(
      [impl = impl_.get(), axis, ids = impl_->select(where, "prescribe"), f = std::move(displacement)] {
        impl->constraints.prescribe(impl->places(ids), axis, f);
      });
}

template <int D>
void Simulation<D>::load(const Where<D>& where, const Vec<D>& force, History history) {
  const auto ids = impl_->select(where, "load");
  if (!force.allFinite()) throw InputError("load: the force is not finite");
  impl_->conditions.push_back([impl = impl_.get(), ids, force, history = std::move(history)] {
    impl->add_load(ids, force, history);
  });
}

template <int D>
void SimulationImpl<D>::add_load(const std::vector<Index>& ids, const Vec<D>& force, History history) {
  // Weights: the area that each particle turns towards the mean normal of the selection; even where there is
  // none.
  std::vector<double> weight(ids.size(), 1.0);
  if (!cloud.B.empty()) {
    Vec<D> normal = Vec<D>::Zero();
    for (const Index i : ids) normal += cloud.B[static_cast<std::size_t>(i)];
    if (normal.norm() > 1e-12 * std::pow(cloud.dx, D - 1)) {
      normal.normalize();
      for (std::size_t k = 0; k < ids.size(); ++k)
        weight[k] = std::max(0.0, normal.dot(cloud.B[static_cast<std::size_t>(ids[k])]));
    }
  }
  double sum = 0;
  for (const double w : weight) sum += w;
  // A particle on a symmetry plane carries its image's load as well.
  const auto times = multiplicity<D>(cloud, planes);
  std::vector<Index> at;
  std::vector<Vec<D>> forces;
  for (std::size_t k = 0; k < ids.size(); ++k) {
    if (weight[k] == 0) continue;
    const auto id = static_cast<std::size_t>(ids[k]);
    at.push_back(place(id));
    forces.push_back(force * (weight[k] / sum * times[id]));
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
  double sum = 0;
  for (const Vec<D>& X : impl_->cloud.X) sum += X[axis] - at;
  impl_->planes.push_back({axis, at, sum > 0 ? 0 : 1});
}

template <int D>
void Simulation<D>::observe(double interval, std::function<void(double)> f) {
  impl_->observers.push_back({interval, 0, std::move(f)});
}

namespace {
// Boundary areas fit for operators that need them: estimated where there are none, closed where they are given.
// Returns the change of closing estimated ones, else -1.
template <int D>
double enclose(Cloud<D>& cloud) {
  if (cloud.B.empty()) return estimate_areas(cloud);
  constexpr double tolerable = 0.2;
  const double change = close_areas(cloud);
  if (!(change < tolerable))
    throw InputError(
        fmt::format("the boundary area vectors do not enclose the body: closing them (sum B = 0, sum X (x) B = "
                    "volume) would change them by {:.0f} %. Check their signs and the volumes, or leave them out",
                    100 * change));
  return -1;
}
}  // namespace

template <int D>
void Simulation<D>::prepare() {
  if (impl_->formulation) return;
  const auto start = std::chrono::steady_clock::now();
  SimulationImpl<D>& s = *impl_;
  if (needs_areas(s.method.operators) && s.planes.empty()) s.guessed_areas = enclose(s.cloud);
  const double reach = s.method.support_dx * s.cloud.dx * (1 + s.method.skin);
  s.particles = assemble<D>(s.cloud, s.materials, s.material, s.planes, reach);
  s.cloud.cells = {};  // the particles have them now
  s.cloud.cell_share = {};
  for (const auto& condition : s.conditions) condition();
  for (const auto& plane : s.planes) {
    std::vector<Index> on;
    for (Index i = 0; i < s.particles.n; ++i)
      if (std::abs(s.particles.X.component(plane.axis)[i] - plane.at) < 1e-6 * s.cloud.dx) on.push_back(i);
    if (!on.empty()) s.constraints.fix(std::move(on), plane.axis);
  }
  if (s.initial_displacement)
    for (Index i = 0; i < s.particles.n; ++i) {
      const Vec<D> X = s.particles.X.template vec<D>(i);
      s.particles.x.template set_vec<D>(i, X + s.initial_displacement(X));
    }
  if (!s.particles.mirror.empty()) s.particles.mirror.positions(s.particles.x);
  auto formulation = make_formulation<D>({s.particles, s.constraints, s.loads, s.method});
  s.health = s.health_of_setup = setup_health<D>(s, *formulation);
  s.formulation = std::move(formulation);
  if (s.initial_velocity)
    for (Index i = 0; i < s.particles.n; ++i)
      s.particles.v.template set_vec<D>(i, s.initial_velocity(s.particles.X.template vec<D>(i)));
  s.setup_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

template <int D>
RunResult Simulation<D>::run(double duration, const RunOptions& options) {
  if (!(duration >= 0) || !std::isfinite(duration))
    throw InputError(fmt::format("run: the duration {:g} s must not be negative", duration));
  if (!(options.cfl > 0)) throw InputError(fmt::format("run: cfl = {:g} must be positive", options.cfl));
  const auto integrator = make_integrator(options.integrator);
  prepare();
  return integrate(*impl_, *integrator, duration, options);
}

template <int D>
RunResult Simulation<D>::relax(const RelaxOptions& options) {
  if (!(options.tolerance > 0))
    throw InputError(fmt::format("relax: tolerance = {:g} must be positive", options.tolerance));
  if (!(options.cfl > 0)) throw InputError(fmt::format("relax: cfl = {:g} must be positive", options.cfl));
  prepare();
  return find_equilibrium(*impl_, options);
}

template <int D>
std::size_t Simulation<D>::size() const {
  return impl_->cloud.size();
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
  return impl_->cloud.X.at(id);
}

template <int D>
Vec<D> Simulation<D>::position(std::size_t id) const {
  return impl_->formulation ? impl_->particles.x.template vec<D>(impl_->place(id)) : reference_position(id);
}
template <int D>
Vec<D> Simulation<D>::displacement(std::size_t id) const {
  return position(id) - reference_position(id);
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
Mat<D> Simulation<D>::first_piola_kirchhoff(std::size_t id) const {
  return prepared(*impl_).first_piola_kirchhoff(impl_->place(id));
}
template <int D>
Mat<D> Simulation<D>::deformation_gradient(std::size_t id) const {
  return prepared(*impl_).deformation_gradient(impl_->place(id));
}
template <int D>
double Simulation<D>::mass(std::size_t id) const {
  return impl_->cloud.V.at(id) * impl_->materials[impl_->material[id]]->density();
}

template <int D>
Vec<D> Simulation<D>::displacement_at(const Vec<D>& X) const {
  // Nearest particles first, until a plane through them is well determined.
  const double dx = impl_->cloud.dx;
  std::vector<std::pair<double, std::size_t>> near;
  for (std::size_t i = 0; i < size(); ++i) {
    const double r2 = (impl_->cloud.X[i] - X).squaredNorm();
    if (r2 < 9 * dx * dx) near.emplace_back(r2, i);
  }
  std::sort(near.begin(), near.end());
  if (near.empty()) throw InputError("displacement_at: no particle within three spacings of the point");
  if (near.front().first < 1e-12 * dx * dx) return displacement(near.front().second);
  Eigen::Matrix<double, D + 1, D + 1> normal = Eigen::Matrix<double, D + 1, D + 1>::Zero();
  Eigen::Matrix<double, D + 1, D> right = Eigen::Matrix<double, D + 1, D>::Zero();
  for (const auto& [r2, i] : near) {
    const double q2 = r2 / (9 * dx * dx);
    const double weight = (1 - q2) * (1 - q2) * (1 - q2) * (1 - q2) / (r2 / (dx * dx) + 0.05);
    Eigen::Matrix<double, D + 1, 1> basis;
    basis << 1, (impl_->cloud.X[i] - X) / dx;
    normal += weight * basis * basis.transpose();
    right += weight * basis * displacement(i).transpose();
  }
  const Eigen::FullPivLU<Eigen::Matrix<double, D + 1, D + 1>> lu(normal);
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
  return prepared(*impl_).bytes() + impl_->particles.bytes();
}

template class Simulation<1>;
template class Simulation<2>;
template class Simulation<3>;

}  // namespace taut
