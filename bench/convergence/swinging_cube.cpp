#include <cmath>
#include <convergence/swinging_cube.hpp>
#include <numbers>

namespace taut::bench {
namespace {

constexpr double k = std::numbers::pi / 2;

/// [sin(kX) cos(kY) cos(kZ), …]: minus the gradient of cos cos cos, over k.
Vec<3> shape(const Vec<3>& X) {
  const Eigen::Array3d s = (k * X.array()).sin(), c = (k * X.array()).cos();
  return {s[0] * c[1] * c[2], c[0] * s[1] * c[2], c[0] * c[1] * s[2]};
}

/// Gradient of `shape`: symmetric, for the field has a potential.
Mat<3> shape_gradient(const Vec<3>& X) {
  const Eigen::Array3d s = (k * X.array()).sin(), c = (k * X.array()).cos();
  Mat<3> g = Mat<3>::Constant(0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) g(i, j) = i == j ? k * c.prod() : -k * s[i] * s[j] * c[3 - i - j];
  return g;
}

}  // namespace

MaterialParameters SwingingCube::material() { return {.E = 17e6, .nu = 0.3, .density = 1100}; }

double SwingingCube::pressure_wave_speed() {
  const MaterialParameters m = material();
  return std::sqrt((m.lambda() + 2 * m.mu()) / m.density);
}

double SwingingCube::angular_frequency() { return std::sqrt(3.0) * k * pressure_wave_speed(); }

double SwingingCube::quarter_period() { return k / angular_frequency(); }

Vec<3> SwingingCube::displacement(const Vec<3>& X, double t) {
  return amplitude() * std::cos(angular_frequency() * t) * shape(X);
}

Vec<3> SwingingCube::velocity(const Vec<3>& X, double t) {
  const double omega = angular_frequency();
  return -amplitude() * omega * std::sin(omega * t) * shape(X);
}

Vec<3> SwingingCube::acceleration(const Vec<3>& X, double t) {
  const double omega = angular_frequency();
  return -omega * omega * displacement(X, t);
}

Mat<3> SwingingCube::stress(const Vec<3>& X, double t) {
  const MaterialParameters m = material();
  const Mat<3> strain = amplitude() * std::cos(angular_frequency() * t) * shape_gradient(X);
  return m.lambda() * strain.trace() * Mat<3>::Identity() + 2 * m.mu() * strain;
}

Cloud<3> swinging_cube_cloud(int intervals, double jitter, unsigned seed) {
  LatticeOptions lattice;
  lattice.dx = 1.0 / intervals;
  lattice.jitter = jitter;
  lattice.seed = seed;
  lattice.cells = true;
  return make_cloud(box<3>(Vec<3>::Zero(), Vec<3>::Ones()), lattice);
}

void hold_swinging_cube(Simulation<3>& simulation) {
  const char* far[] = {"x_max", "y_max", "z_max"};
  for (int axis = 0; axis < 3; ++axis) {
    simulation.symmetry_plane(axis, 0);
    for (int tangential = 0; tangential < 3; ++tangential)
      if (tangential != axis) simulation.roller(simulation.face(far[axis]), tangential);
  }
}

void CubeErrorSums::add(const Cloud<3>& cloud, double t, const std::function<Vec<3>(std::size_t)>& velocity,
                        const std::function<double(std::size_t)>& stress_xx,
                        const std::vector<Mat<3>>& recovered) {
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Vec<3> exact_v = SwingingCube::velocity(cloud.X[i], t);
    const double exact_s = SwingingCube::stress(cloud.X[i], t)(0, 0);
    dv_ += cloud.V[i] * (velocity(i) - exact_v).squaredNorm();
    v_ += cloud.V[i] * exact_v.squaredNorm();
    ds_ += cloud.V[i] * std::pow(stress_xx(i) - exact_s, 2);
    s_ += cloud.V[i] * exact_s * exact_s;
    if (!recovered.empty()) dr_ = dr_.value_or(0) + cloud.V[i] * std::pow(recovered[i](0, 0) - exact_s, 2);
  }
}

CubeErrors CubeErrorSums::errors() const {
  CubeErrors errors{std::sqrt(dv_ / v_), std::sqrt(ds_ / s_), {}};
  if (dr_) errors.recovered = std::sqrt(*dr_ / s_);
  return errors;
}

}  // namespace taut::bench
