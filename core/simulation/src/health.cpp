#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/formulations/health_sweeps.hpp>
#include <taut/simulation/health_watch.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

bool Health::suspect() const {
  return std::any_of(measures.begin(), measures.end(), [](const HealthMeasure& m) { return m.flagged(); });
}

const HealthMeasure* Health::find(const std::string& name) const {
  for (const HealthMeasure& m : measures)
    if (m.name == name) return &m;
  return nullptr;
}

std::string Health::complaints() const {
  std::string text;
  for (const HealthMeasure& m : measures)
    if (m.flagged())
      text += fmt::format("{}{} {:.3g} (limit {:g})", text.empty() ? "" : ", ", m.name, m.value, m.limit);
  return text;
}

namespace {

// Volume and mass of the particles against what is known of the body.
template <int D>
void check_volume(const SimulationImpl<D>& s, Health& health) {
  const Cloud<D>& cloud = s.cloud;
  double volume = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.extra.empty() || !cloud.extra[i]) volume += cloud.V[i];
  if (cloud.body_volume > 0)
    health.measures.push_back({"health_volume_error",
                               std::abs(volume / cloud.body_volume - 1),
                               0.05,
                               false,
                               "volume of the particles over that of the body, less one",
                               -1,
                               {}});
  if (!cloud.guessed_volumes) return;
  // Right for nodes of a mesh; the middles of its elements would need their volumes. Nothing tells them
  // apart.
  health.measures.push_back({"health_volume_guessed",
                             1,
                             1,
                             false,
                             "volumes were not given: the body is taken to end at its outermost particles",
                             -1,
                             {}});
}

}  // namespace

template <int D>
Health setup_health(const SimulationImpl<D>& s, const Formulation<D>& formulation) {
  Health health;
  check_volume(s, health);
  if (formulation.frequency() > 0) {
    const double speed = s.particles.wave_speed();
    const Index at = formulation.stiffest();
    const double spacing =
        s.particles.spacing.empty() || at < 0 ? s.particles.dx : s.particles.spacing.component(0)[at];
    const double relative = formulation.frequency() * spacing / speed;
    // Sane operators have 1.7 to 4, with small cells on a surface or a strong control a multiple of it; what
    // is a hundred times slower than it should be was never anything but wrong.
    constexpr double sick = 100;
    if (relative > sick)
      throw InputError(
          fmt::format("the operators are sick at particle {} at {}: their highest frequency is {:.3g} c / "
                      "dx, sane ones have 1.7 to 4, "
                      "so that runs would take {:.0f} times the steps, to no good result. Look for volumes "
                      "that are far too small, "
                      "particles that nearly coincide, or area vectors that do not fit; or use other "
                      "operators or a larger support_dx",
                      at < 0 ? -1 : s.particles.id[static_cast<std::size_t>(at)],
                      at < 0 ? std::string("?") : describe<D>(s.particles.reference_position(at)), relative,
                      relative / 3));
    health.measures.push_back(measure_at(s.particles, "health_frequency", relative, 8.0,
                                         "highest frequency times dx / c: the step that the operators cost",
                                         at));
  }
  formulation.check(health);
  return health;
}

#define TAUT_INSTANTIATE(D) template Health setup_health<D>(const SimulationImpl<D>&, const Formulation<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
