#include <taut/base/error.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/integrators/leapfrog.hpp>
#include <taut/integrators/runge_kutta.hpp>
#include <utility>

namespace taut {

namespace {

std::unique_ptr<Integrator> make_leapfrog() { return std::make_unique<Leapfrog>(); }

std::vector<IntegratorEntry>& registry() {
  static std::vector<IntegratorEntry> entries = {
      {"leapfrog", "kick-drift-kick, symplectic, second order; the cheapest", make_leapfrog},
      {"central_difference", "the same scheme by its other name", make_leapfrog},
      {"tvd_rk2", "Runge-Kutta of second order (Shu & Osher); undamped oscillations grow slowly",
       make_tvd_rk2},
      {"ssp_rk3", "Runge-Kutta of third order (Shu & Osher)", make_ssp_rk3},
  };
  return entries;
}

const IntegratorEntry* look_up(std::string_view name) {
  for (const IntegratorEntry& entry : registry())
    if (entry.name == name) return &entry;
  return nullptr;
}

}  // namespace

const std::vector<IntegratorEntry>& integrators() { return registry(); }

std::vector<std::string> integrator_names() {
  std::vector<std::string> names;
  for (const IntegratorEntry& entry : registry()) names.push_back(entry.name);
  return names;
}

std::unique_ptr<Integrator> make_integrator(std::string_view name) {
  if (const IntegratorEntry* entry = look_up(name)) return entry->make();
  throw InputError("unknown integrator \"" + std::string(name) +
                   "\"; valid: " + join_names(integrator_names()));
}

void register_integrator(IntegratorEntry entry) {
  if (entry.name.empty()) throw InputError("register_integrator: it needs a name");
  if (!entry.make) throw InputError("register_integrator: nothing makes \"" + entry.name + "\"");
  if (look_up(entry.name))
    throw InputError("register_integrator: there is an integrator \"" + entry.name + "\" already");
  registry().push_back(std::move(entry));
}

}  // namespace taut
