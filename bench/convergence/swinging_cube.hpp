#pragma once
/// \file
/// The swinging cube: free vibration of a linear elastic unit cube, known exactly (Lee, Gil and Bonet 2016;
/// case A6).

#include <functional>
#include <optional>
#include <taut/simulation/simulation.hpp>
#include <vector>

namespace taut::bench {

/// u = U0 cos(omega t) [sin(πX/2) cos(πY/2) cos(πZ/2), cos sin cos, cos cos sin], omega = (√3/2) π c_p: a
/// curl-free standing wave in the unit cube. The planes X, Y, Z = 0 are symmetry planes; on X, Y, Z = 1 the
/// tangential displacement is zero and the normal traction vanishes by itself. Small strain, SI units.
class SwingingCube {
 public:
  static MaterialParameters material();
  static double amplitude() { return 5e-4; }  ///< U0 [m]
  static double snapshot() { return 0.002; }  ///< time at which the sources take errors [s]
  static double quarter_period();             ///< [s]; the snapshot is near its middle
  static double pressure_wave_speed();        ///< c_p [m/s]
  static double angular_frequency();          ///< omega [1/s]

  static Vec<3> displacement(const Vec<3>& X, double t);
  static Vec<3> velocity(const Vec<3>& X, double t);
  static Vec<3> acceleration(const Vec<3>& X, double t);
  /// sigma = lambda tr(eps) I + 2 mu eps [Pa].
  static Mat<3> stress(const Vec<3>& X, double t);
};

/// Nodes of the unit cube, `intervals` along each edge; jitter in spacings.
Cloud<3> swinging_cube_cloud(int intervals, double jitter, unsigned seed);

/// The cube's boundary conditions on a simulation of that cloud.
void hold_swinging_cube(Simulation<3>& simulation);

/// Relative L2 errors over the particles with their tributary volumes V, sqrt(sum V |y - y_exact|^2 / sum V
/// |y_exact|^2).
struct CubeErrors {
  double velocity = 0;
  double stress = 0;                ///< of the component P_xX
  std::optional<double> recovered;  ///< the same of the stress that is recovered for output
};

/// Gathers those sums at one time or, for an error over a time, at several: sums over particles and times.
class CubeErrorSums {
 public:
  /// `velocity(i)` and `stress_xx(i)` of the cloud's particle i at the cube's time `t`, and the stress that
  /// is recovered, or nothing.
  void add(const Cloud<3>& cloud, double t, const std::function<Vec<3>(std::size_t)>& velocity,
           const std::function<double(std::size_t)>& stress_xx, const std::vector<Mat<3>>& recovered);
  CubeErrors errors() const;

 private:
  double dv_ = 0, v_ = 0, ds_ = 0, s_ = 0;
  std::optional<double> dr_;
};

}  // namespace taut::bench
