#include <cmath>
#include <convergence/bent_bar.hpp>
#include <convergence/run_row.hpp>

namespace taut::bench {

MaterialParameters BentBar::material() { return {.E = 17e6, .nu = 0.3, .density = 1100}; }

Vec<3> BentBar::displacement(const Vec<3>& X) {
  const double nu = material().nu;
  return curvature() *
         Vec<3>(-X[0] * X[1], (X[0] * X[0] + nu * (X[1] * X[1] - X[2] * X[2])) / 2, nu * X[1] * X[2]);
}

Mat<3> BentBar::stress(const Vec<3>& X) {
  Mat<3> sigma = Mat<3>::Zero();
  sigma(0, 0) = -material().E * curvature() * X[1];
  return sigma;
}

BentBarRun run_bent_bar(const Method& method, int intervals, double jitter, unsigned seed, int threads) {
  const double h = 1.0 / intervals, L = BentBar::length();
  LatticeOptions lattice{.dx = h, .jitter = jitter, .seed = seed, .cells = true};
  Simulation<3> simulation(make_cloud(box<3>({0, -0.5, 0}, {L, 0.5, 0.5}), lattice),
                           make_material<3>("linear_elastic", BentBar::material()), method);
  simulation.symmetry_plane(0, 0);
  simulation.symmetry_plane(2, 0);
  simulation.roller([](const Vec<3>& X) { return X.norm() < 1e-9; }, 1);
  // The traction, row by row, each with the integral of its hat function: no row's share changes the moment.
  for (int j = 0; j <= intervals; ++j) {
    const double y = -0.5 + j * h;
    double width = h, at = y;
    if (j == 0 || j == intervals) width = h / 2, at = y - std::copysign(h / 3, y);
    const double force = BentBar::stress({L, at, 0})(0, 0) * width * 0.5;
    if (force == 0) continue;
    simulation.load([=](const Vec<3>& X) { return X[0] > L - 1e-9 && std::abs(X[1] - y) < 1e-9; },
                    Vec<3>(force, 0, 0));
  }
  BentBarRun run;
  run.row.scene = std::string("bent_bar_") + (jitter > 0 ? "jittered" : "lattice");
  set_method(run.row, method);
  run.row.material = "linear_elastic";
  run.row.integrator = "relax";
  run.row.dx = h;
  run.row.threads = threads;
  run.row.unit = std::string("m");
  // Wide supports leave a lattice soft modes that come to rest late: given up as broken.
  const RunResult result = simulation.relax({.tolerance = 1e-5, .max_steps = 3000 * intervals});
  set_run(run.row, simulation, result);
  if (result.status != Status::ok) return run;
  const Vec<3> tip(L, 0, 0);
  run.row.value = simulation.displacement_at(tip)[1];
  run.row.reference = BentBar::displacement(tip)[1];
  run.row.error = run.tip_error = error_of(*run.row.value, *run.row.reference, false);
  return run;
}

}  // namespace taut::bench
