#include <cmath>
#include <scaling/dense_steps.hpp>
#include <scaling/engine_step.hpp>
#include <scaling/job.hpp>
#include <taut/base/error.hpp>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {
namespace {

/// The engine and the dense matrices with the same operator, `standard`.
template <int D>
void compare_with_dense(const Job& job, std::int64_t particles, double support_dx) {
  const Cloud<D> cloud = cube<D>(particles, Arrangement::lattice);
  const auto n = static_cast<double>(cloud.size());
  Method method = with_defaults({});
  method.operators = "standard";
  method.support_dx = support_dx;
  method.pair_precision = PairPrecision::double_precision;
  EngineStep<D> engine(cloud, method);
  const Kernel kernel(method.kernel, D);
  std::vector<Vec<D>> start(cloud.size());
  for (std::size_t i = 0; i < start.size(); ++i) start[i] = start_displacement<D>(cloud.X[i]);
  DenseSteps<D> dense(cloud, kernel, support_dx * cloud.dx / kernel.radius_factor(), step_parameters(), start,
                      DenseSteps<D>::Form::conjugate);
  const auto expected = dense.accelerations();
  const std::vector<Vec<D>> ours = engine.start_accelerations();
  double error = 0;
  for (std::size_t i = 0; i < ours.size(); ++i)
    error = std::max(error, (ours[i].transpose() - expected.row(static_cast<Eigen::Index>(i))).norm());
  error /= expected.rowwise().norm().maxCoeff();
  if (!(error < 1e-10))
    throw RunError(
        fmt::format("dense matrices of {} particles differ from taut by {:g} in their accelerations",
                    cloud.size(), error));

  Row row;
  row.scene = scene_name<D>(Arrangement::lattice);
  row.operators = method.operators;
  row.material = "neo_hookean";
  row.kernel = method.kernel;
  row.support_dx = support_dx;
  row.dx = cloud.dx;
  row.particles = static_cast<std::int64_t>(cloud.size());
  row.pairs = engine.simulation().pairs();
  row.threads = job.threads;
  row.precision = "double";
  Row ours_row = row, dense_row = row;
  ours_row.formulation = "tl_displacement";
  ours_row.integrator = "leapfrog";
  ours_row.setup_s = engine.simulation().setup_seconds();
  ours_row.bytes_per_particle = engine.bytes_per_particle();
  dense_row.formulation = "baseline_dense";
  dense_row.integrator = "central_difference";
  dense_row.bytes_per_particle = static_cast<double>(dense.bytes()) / n;

  const auto measured =
      job.measure(fmt::format("TL step against dense matrices, {}D, {} particles", D, cloud.size()),
                  {{"taut, double", [&] { return engine.rate(job.threads, job.least_seconds); }},
                   {"dense matrices",
                    [&] {
                      const auto step = [&] { dense.step(engine.step()); };
                      step();
                      return n / seconds_per_call(step, job.least_seconds);
                    }}},
                  1e-6, "M particle-steps/s");
  ours_row.particle_steps_per_s = measured[0].median();
  dense_row.particle_steps_per_s = measured[1].median();
  job.add(dense_row, "acceleration_difference", error, "1");
  job.add(ours_row, "rate", measured[0], "particle-steps/s");
  job.add(dense_row, "rate", measured[1], "particle-steps/s");
  job.add(ours_row, "ratio_to_dense", measured[0].median() / measured[1].median(), "1");
}

}  // namespace

void measure_dense(const Job& job) {
  constexpr std::int64_t most = 3969;  // matrices of 126 MB each
  if (job.quick) return compare_with_dense<2>(job, most, 2.6);
  // Radii of the plates of the thesis (University of Cape Town), and the smallest one in 3D.
  for (const std::int64_t n : std::initializer_list<std::int64_t>{16, 64, 256, 1024, 2500, most})
    compare_with_dense<2>(job, n, 2.6);
  for (const std::int64_t n : {27, 125, 512, 1728, 3375}) compare_with_dense<3>(job, n, 1.5);
}

}  // namespace taut::bench
