#include <fmt/format.h>
#include <omp.h>

#include <chrono>
#include <cmath>
#include <lib/names.hpp>
#include <scaling/engine_step.hpp>
#include <taut/base/error.hpp>
#include <taut/kernels/kernel.hpp>

namespace taut::bench {

MaterialParameters step_parameters() { return {.E = 1e7, .nu = 0.3, .density = 1000}; }

template <int D>
Vec<D> start_displacement(const Vec<D>& X) {
  Vec<D> u;
  for (int d = 0; d < D; ++d) {
    double phase = 0.3 + d;
    for (int e = 0; e < D; ++e) phase += (1.7 + 0.9 * e - 0.6 * d) * X[e];
    u[d] = 0.02 * std::sin(phase);
  }
  return u;
}

namespace {

constexpr double cfl = 0.6;
constexpr double forever = 1e9;  // [s], told apart from the next step; steps are stopped by their number

template <int D>
std::shared_ptr<const Material<D>> step_material(bool updated) {
  return make_material<D>(updated ? "hypoelastic" : "neo_hookean", step_parameters());
}

}  // namespace

template <int D>
EngineStep<D>::EngineStep(Cloud<D> cloud, const Method& method)
    : updated_(is_updated(method.formulation)),
      dx_(cloud.dx),
      simulation_(std::move(cloud), step_material<D>(updated_), method) {
  if (updated_) {
    const double R = method.support_dx * dx_, h = R / Kernel(method.kernel, D).radius_factor();
    const double dt = cfl * h / step_material<D>(true)->wave_speed();
    // Half of the skin distance is used up between two rebuilds.
    const double speed = method.skin * R / 2 / ((rebuild_every - 0.5) * dt);
    simulation_.set_velocity([speed](const Vec<D>& X) {
      Vec<D> v = start_displacement<D>(X) * (1e-3 * speed);
      v[0] += speed;
      return v;
    });
  } else {
    simulation_.set_displacement(start_displacement<D>);
  }
  const RunOptions one_step{
      .integrator = "leapfrog", .cfl = cfl, .max_step = 0, .progress = [](std::int64_t, double, double) {
        return false;
      }};
  simulation_.run(0);
  for (std::size_t i = 0; i < simulation_.size(); ++i) start_.push_back(simulation_.acceleration(i));
  dt_ = simulation_.run(forever, one_step).time;
}

template <int D>
double EngineStep<D>::rate(int threads, double least_seconds) {
  using Clock = std::chrono::steady_clock;
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  Clock::time_point start;
  double seconds = 0;
  std::int64_t counted = 0;
  const RunOptions options{.integrator = "leapfrog",
                           .cfl = cfl,
                           .max_step = 0,
                           .progress = [&](std::int64_t steps, double, double) {
                             const auto now = Clock::now();
                             if (steps == 1) {
                               start = now;
                               return true;
                             }
                             counted = steps - 1;
                             seconds = std::chrono::duration<double>(now - start).count();
                             return seconds < least_seconds || (updated_ && counted % rebuild_every != 0);
                           }};
  const RunResult result = simulation_.run(forever, options);
  omp_set_num_threads(before);
  rebuilds_ = result.rebuilds;
  if (result.status != Status::ok)
    throw RunError(fmt::format("the {} body of {} particles broke while its steps were timed: {}",
                               simulation_.method().formulation, simulation_.size(), result.breakdown->what));
  return static_cast<double>(counted) * static_cast<double>(simulation_.size()) / seconds;
}

template <int D>
double EngineStep<D>::bytes_per_particle() const {
  return static_cast<double>(simulation_.bytes()) / static_cast<double>(simulation_.size());
}
template <int D>
double EngineStep<D>::neighbours() const {
  return static_cast<double>(simulation_.pairs()) / static_cast<double>(simulation_.size());
}

#define TAUT_INSTANTIATE(D)                             \
  template Vec<D> start_displacement<D>(const Vec<D>&); \
  template class EngineStep<D>;
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut::bench
