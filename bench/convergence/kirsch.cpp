#include <cmath>
#include <convergence/kirsch.hpp>
#include <numbers>

namespace taut::bench {

Vec<2> KirschPlate::displacement(const Vec<2>& X) const {
  const double r = X.norm(), theta = std::atan2(X[1], X[0]), q = a / r, nu = material.nu;
  const double kappa = material.plane == Plane::stress ? (3 - nu) / (1 + nu) : 3 - 4 * nu;
  const double c2 = std::cos(2 * theta), s2 = std::sin(2 * theta), scale = S * r / (8 * material.mu());
  const double radial =
      scale * (kappa - 1 + 2 * c2 + 2 * q * q * (1 + (kappa + 1) * c2) - 2 * std::pow(q, 4) * c2);
  const double along = scale * (-2 + 2 * q * q * (1 - kappa) - 2 * std::pow(q, 4)) * s2;
  return {radial * std::cos(theta) - along * std::sin(theta),
          radial * std::sin(theta) + along * std::cos(theta)};
}

Mat<2> KirschPlate::stress(const Vec<2>& X) const {
  const double r = X.norm(), theta = std::atan2(X[1], X[0]), q2 = a * a / (r * r), q4 = q2 * q2;
  const double c2 = std::cos(2 * theta), s2 = std::sin(2 * theta), c4 = std::cos(4 * theta),
               s4 = std::sin(4 * theta);
  Mat<2> sigma;
  sigma(0, 0) = S * (1 - q2 * (1.5 * c2 + c4) + 1.5 * q4 * c4);
  sigma(1, 1) = S * (-q2 * (0.5 * c2 - c4) - 1.5 * q4 * c4);
  sigma(0, 1) = sigma(1, 0) = S * (-q2 * (0.5 * s2 + s4) + 1.5 * q4 * s4);
  return sigma;
}

Cloud<2> quarter_ring_cloud(double a, double b, double dx) {
  constexpr double right_angle = std::numbers::pi / 2;
  const int rings = static_cast<int>(std::lround((b - a) / dx));
  const double step = (b - a) / rings;
  Cloud<2> cloud;
  cloud.dx = step;
  const auto point = [&](double r, int j, int n) {
    // The ends lie on the symmetry planes exactly.
    if (j == 0) return Vec<2>(r, 0);
    if (j == n) return Vec<2>(0, r);
    return Vec<2>(r * std::cos(right_angle * j / n), r * std::sin(right_angle * j / n));
  };
  double sectors = 0, polygon = 0;
  for (int k = 0; k <= rings; ++k) {
    const double r = a + k * step, inner = std::max(a, r - step / 2), outer = std::min(b, r + step / 2);
    const int n = static_cast<int>(std::lround(right_angle * r / step));
    const double sector = (outer * outer - inner * inner) / 2 * right_angle / n;
    for (int j = 0; j <= n; ++j) {
      const bool end = j == 0 || j == n;
      Vec<2> area = Vec<2>::Zero();
      // A chord's normal times its length is the turned difference of its ends; each end bears half.
      const auto chord = [&](int from, int to, double sign) {
        const Vec<2> d = point(r, to, n) - point(r, from, n);
        area += sign / 2 * Vec<2>(d[1], -d[0]);
      };
      const double sign = k == 0 ? -1 : 1;
      if (k == 0 || k == rings) {
        if (j > 0) chord(j - 1, j, sign);
        if (j < n) chord(j, j + 1, sign);
      }
      // The straight edges; symmetry planes take these away again.
      if (j == 0) area[1] -= outer - inner;
      if (j == n) area[0] -= outer - inner;
      cloud.X.push_back(point(r, j, n));
      cloud.V.push_back(end ? sector / 2 : sector);
      cloud.B.push_back(area);
      sectors += cloud.V.back();
    }
    if (k == 0 || k == rings) polygon += (k == 0 ? -1 : 1) * n * r * r / 2 * std::sin(right_angle / n);
  }
  for (double& V : cloud.V) V *= polygon / sectors;
  return cloud;
}

Cloud<2> quarter_ring_lattice(double a, double b, double dx) {
  const auto ring = implicit<2>([a, b](const Vec<2>& X) { return std::max(a - X.norm(), X.norm() - b); },
                                Vec<2>::Zero(), Vec<2>::Constant(b));
  LatticeOptions options;
  options.dx = dx;
  options.cells = true;
  return make_cloud(ring, options);
}

}  // namespace taut::bench
