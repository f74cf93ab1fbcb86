#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/formulations/assembly.hpp>
#include <taut/formulations/registry.hpp>
#include <taut/integrators/step_limits.hpp>
#include <taut/particles/pair_rule.hpp>
#include <taut/simulation/health_watch.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

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

}  // namespace

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

#define TAUT_INSTANTIATE(D) template void build<D>(SimulationImpl<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
