#pragma once
// Bodies of the regression tests: the truss and the cantilever of Tran-Duc et al. (2023), sections 3.1
// and 3.2.

#include <taut/taut.hpp>

namespace taut {

enum class Body { truss, cantilever };

struct Case {
  Body body = Body::truss;
  double load = 0;  // [N]: axial for the truss, transverse for the cantilever
  double nu = 0;
  double dx = 2e-3;
  const char* material = "st_venant_kirchhoff";
  Lattice lattice = Lattice::node_centred;
  double jitter = 0;
  Plane plane = Plane::stress;
  Method method = with_defaults({});
  RelaxOptions solve{};
};

struct Outcome {
  RunResult result;
  Vec<2> tip;  // displacement of the mid-height end point [m]
};

inline Outcome solve(const Case& c) {
  const double L = 0.2, H = c.body == Body::truss ? 0.05 : 0.02, E = c.body == Body::truss ? 2e6 : 20e6;
  LatticeOptions lattice{.dx = c.dx,
                         .lattice = c.lattice,
                         .jitter = c.jitter,
                         .cells = c.method.formulation == "tl_stress_points"};
  // Cell-centred particles do not lie on the clamped face: three columns beyond it are held.
  const bool cells = c.lattice == Lattice::cell_centred;
  if (cells) lattice.layers[0] = {3, 0};
  Simulation<2> simulation(
      make_cloud(box<2>({0, 0}, {L, H}), lattice),
      make_material<2>(c.material, {.E = E, .nu = c.nu, .density = 1000, .plane = c.plane}), c.method);
  if (cells)
    simulation.clamp([](const Vec<2>& X) { return X[0] < 0; });
  else
    simulation.clamp(simulation.face("x_min"));
  simulation.load(simulation.face("x_max"), c.body == Body::truss ? Vec<2>(c.load, 0) : Vec<2>(0, c.load));
  Outcome outcome;
  outcome.result = simulation.relax(c.solve);
  outcome.tip = simulation.displacement_at({L, H / 2});
  return outcome;
}

/// The discretisation of Tran-Duc et al.: their kernel, h = 1.2 dx.
inline Method updated_lagrangian(const char* formulation) {
  Method method = with_defaults({});
  method.formulation = formulation;
  method.kernel = "sinc5";
  method.support_dx = 2.4;
  return method;
}

}  // namespace taut
