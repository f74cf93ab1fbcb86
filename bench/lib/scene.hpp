#pragma once
/// \file
/// A scene: one body, its loads, what is measured and the methods to compare. Plain values; every field is
/// documented in bench/scenes/README.md. SI units.

#include <array>
#include <lib/place.hpp>
#include <map>
#include <optional>
#include <string>
#include <taut/formulations/auto_method.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/materials/material.hpp>
#include <taut/operators/method.hpp>
#include <utility>
#include <vector>

namespace taut::bench {

/// Values of the swept quantities, by name: "load", "nu", "dx", "region_density". Absent where the scene does
/// not sweep.
using SweepPoint = std::map<std::string, double>;

struct ShapeSpec {
  std::string type;
  std::vector<double> min, max, centre, from, to;
  double radius = 0, inner_radius = 0, outer_radius = 0;
  std::string file;           ///< csv: path as found from the scene file
  std::vector<ShapeSpec> of;  ///< union, difference
  Place place;
};

struct LatticeSpec {
  Lattice kind = Lattice::node_centred;
  double dx = 0;
  double jitter = 0;
  unsigned seed = 1;
  Place place;
};

struct MaterialSpec {
  std::string model;
  MaterialParameters parameters;
  Place place;
};

/// Leaves out what its model has no parameter for, as where a run has a model of its own.
void keep_own(MaterialSpec& material);

/// A part of the body: a face of its bounding box, a box of intervals, or both at once.
struct Selection {
  std::string on;  ///< "x_min" … "z_max", or empty
  std::map<int, std::array<double, 2>> where;
  bool empty() const { return on.empty() && where.empty(); }
};

struct RegionSpec {
  Selection selection;
  MaterialSpec material;
  Place place;
};

/// A factor in time.
struct HistorySpec {
  std::string type = "constant";
  double start = 0, duration = 0;
  std::vector<std::array<double, 2>> values;  ///< table: times and factors
  /// Factor at time t [s]: 1 for constant; 0 → 1 for linear and smoothstep; one hump for raised_cosine; a box
  /// for square; linear interpolation for table.
  double factor(double t) const;
};

struct BoundarySpec {
  std::string type;
  Selection selection;
  int layers = 0;  ///< clamp on a cell-centred lattice: particle layers beyond the face
  int axis = 0;
  double displacement = 0;
  double force = 0;
  std::vector<double> direction, acceleration;
  std::optional<HistorySpec> history;
  Place place;
};

struct InitialSpec {
  Selection selection;
  std::vector<double> velocity, stretch;  ///< either may be empty
  Place place;
};

struct SolveSpec {
  std::string mode = "relax";
  double duration = 0;
  std::string integrator = "leapfrog";
  double cfl = 0.6, max_step = 0, tolerance = 1e-6, ramp_time = 0, free_time = 0;
  std::int64_t max_steps = 10'000'000;
  int samples = 1000;  ///< dynamic: points of each history
  Place place;
};

/// Which cases a probe is taken in: for each key, the values (or labels, or formulations) it wants.
struct OnlySpec {
  std::map<std::string, std::vector<double>> values;
  std::vector<std::string> runs, formulations;
};

struct ReferenceSpec {
  std::optional<double> number;
  std::string file, column;                 ///< CSV path as found from the scene file
  std::map<std::string, std::string> keys;  ///< sweep name → key column
  double scale = 1;
  std::string analytic;
  std::string label = "reference";
  Place place;
};

/// What a source printed for the same quantity, shown beside ours.
struct PrintedSpec {
  std::string label, column;
  std::vector<std::string> runs;  ///< labels of the runs it compares with; empty: all
  double scale = 1;
};

struct ProbeSpec {
  std::string name, type;
  int row = 0, column = 0;  ///< component: vector quantities use row only
  std::vector<double> at;
  Place at_place;
  std::string measure = "final";
  std::array<double, 2> window{0, 1e300};
  std::string over;  ///< peak: name of the probe whose peak divides this one
  OnlySpec only;
  std::optional<ReferenceSpec> reference;
  std::vector<PrintedSpec> printed;
  Place place;

  std::string unit() const;         ///< of the result: "m", "Pa", "s", "1", …
  std::string signal_unit() const;  ///< of what is sampled
};

struct RunSpec {
  std::string label;
  Method method = with_defaults({});
  std::vector<FiredRule> automatic;  ///< how the method was chosen; empty unless formulation is "auto"
  LatticeSpec lattice;
  std::string material;  ///< model; empty: the scene's
  std::optional<Plane> plane;
  SolveSpec solve;
  std::map<std::string, std::vector<double>> only;  ///< swept values at which it is run; empty: all
  Place place;
};

struct PictureSpec {
  std::string title;
  std::string field = "von_mises";
  std::array<double, 3> from{0, 0, 1};  ///< direction in which the viewer stands
  SweepPoint of;                        ///< which case of each run
  std::vector<std::string> runs;        ///< labels; empty: all
  Place place;
};

struct Scene {
  std::string file;  ///< as given
  std::string name, title, description;
  int dimension = 2;
  double accuracy = 0.01;  ///< wanted relative error
  ShapeSpec geometry;
  LatticeSpec lattice;  ///< of runs that give no other; unused for a cloud from a file
  MaterialSpec material;
  SolveSpec solve;  ///< likewise
  std::vector<RegionSpec> regions;
  std::vector<BoundarySpec> boundaries;
  std::vector<InitialSpec> initial;
  std::vector<ProbeSpec> probes;
  std::vector<std::pair<std::string, std::vector<double>>> sweep;  ///< outermost first
  std::vector<RunSpec> runs;
  std::vector<PictureSpec> pictures;
  Place place;

  /// Every combination of the swept values; one empty point when nothing is swept.
  std::vector<SweepPoint> points() const;
};

/// The scene's material as a run and a sweep point change it.
MaterialSpec material_of(const Scene& scene, const RunSpec& run, const SweepPoint& point);
MaterialSpec material_of(const Scene& scene, const RegionSpec& region, const RunSpec& run,
                         const SweepPoint& point);
LatticeSpec lattice_of(const RunSpec& run, const SweepPoint& point);
/// Force of a load boundary [N] at a sweep point.
double force_of(const BoundarySpec& boundary, const SweepPoint& point);
/// Whether a run is made at this point.
bool wanted(const RunSpec& run, const SweepPoint& point);
/// Whether a probe is taken in this case.
bool wanted(const ProbeSpec& probe, const RunSpec& run, const SweepPoint& point);

}  // namespace taut::bench
