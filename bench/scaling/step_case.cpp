#include <fstream>
#include <scaling/peak_memory.hpp>
#include <scaling/step_case.hpp>
#include <string>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {
namespace {

/// What the last level of cache holds [bytes], as the kernel tells: a guest's processor may tell of its
/// host's.
double cache_bytes() {
  for (const char* level : {"index3", "index2"}) {
    std::ifstream in(std::string("/sys/devices/system/cpu/cpu0/cache/") + level + "/size");
    double kilobytes = 0;
    if (in >> kilobytes) return kilobytes * 1024;
  }
  return 32 << 20;
}

/// A body set up, with the most memory that this took.
template <int D>
EngineStep<D> set_up(std::int64_t particles, const StepSpec& spec, const Method& method,
                     std::optional<double>& peak) {
  const PeakMemory memory;
  EngineStep<D> engine(cube<D>(particles, spec.arrangement), method);
  peak = memory.growth();
  return engine;
}

}  // namespace

template <int D>
Method StepCase<D>::method_of(const StepSpec& spec) {
  const Neighbourhood& hood = neighbourhood<D>(spec.neighbours, spec.arrangement);
  Method method = with_defaults({});
  method.formulation = spec.formulation;
  method.support_dx = hood.support_dx;
  method.skin = hood.skin;
  method.pair_precision = spec.precision;
  return method;
}

template <int D>
StepCase<D>::StepCase(const Job& job, std::int64_t particles, const StepSpec& spec)
    : particles_(particles),
      spec_(spec),
      method_(method_of(spec)),
      engine_(set_up<D>(particles, spec, method_, peak_bytes_)) {
  row_.scene = scene_name<D>(spec.arrangement);
  row_.formulation = spec.formulation;
  row_.operators = spec.total() ? "corrected" : "";
  row_.material = spec.total() ? "neo_hookean" : "hypoelastic";
  row_.kernel = method_.kernel;
  row_.support_dx = method_.support_dx;
  row_.dx = engine_.dx();
  row_.particles = static_cast<std::int64_t>(engine_.simulation().size());
  row_.pairs = engine_.simulation().pairs();
  row_.precision = spec.total() ? to_string(spec.precision) : "recomputed";
  row_.integrator = "leapfrog";
  row_.setup_s = engine_.simulation().setup_seconds();
  row_.bytes_per_particle = engine_.bytes_per_particle();
  // The traffic of a particle does not depend on how many there are, once there are many.
  constexpr std::int64_t many = 1'000'000;
  if (!job.limit("triad", spec.threads.back())) return;
  const Cloud<D> cloud = cube<D>(std::min(particles, many), spec.arrangement);
  traffic_ = spec.total() ? total_lagrangian_traffic(cloud, method_)
                          : updated_lagrangian_traffic(cloud, method_, EngineStep<D>::rebuild_every);
}

template <int D>
std::string StepCase<D>::label() const {
  return fmt::format("{}, {}, {} ({:.1f}) neighbours, {}", spec_.total() ? "TL" : "UL",
                     to_string(spec_.arrangement), spec_.neighbours, engine_.neighbours(), row_.precision);
}

template <int D>
Contestant StepCase<D>::contestant(const Job& job, int threads) {
  return {fmt::format("{}, {}", label(), thread_label(threads)),
          [this, least = job.least_seconds, threads] { return engine_.rate(threads, least); }};
}

template <int D>
void StepCase<D>::add_setup(const Job& job) const {
  Row row = row_;
  row.threads = job.threads;
  job.add(row, "setup", engine_.simulation().setup_seconds(), "s");
  job.add(row, "bytes_per_particle", engine_.bytes_per_particle(), "B");
  if (peak_bytes_)
    job.add(row, "peak_bytes_per_particle", *peak_bytes_ / static_cast<double>(*row.particles), "B");
  if (!traffic_) return;
  job.add(row, "bytes_per_step", traffic_->bytes, "B");
  job.add(row, "flops_per_step", traffic_->flops, "1");
}

template <int D>
void StepCase<D>::add_rate(const Job& job, int threads, const Samples& rate) const {
  Row row = row_;
  row.threads = threads;
  row.particle_steps_per_s = rate.median();
  job.add(row, "rate", rate, "particle-steps/s");
  if (!traffic_) return;
  const auto peak = job.limit("multiply_add_peak", threads);
  if (peak) job.add(row, "fraction_of_peak_flops", rate.median() * traffic_->flops / *peak, "1");
  // Where all that a step touches may stay in the cache, memory sets no bound.
  if (traffic_->bytes * static_cast<double>(*row.particles) < 4 * cache_bytes()) return;
  if (const auto triad = job.limit("triad", threads)) {
    const double bound = *triad / traffic_->bytes;
    job.add(row, "bound_rate", bound, "particle-steps/s");
    job.add(row, "fraction_of_limit", rate.median() / bound, "1");
  }
}

template class StepCase<1>;
template class StepCase<2>;
template class StepCase<3>;

}  // namespace taut::bench
