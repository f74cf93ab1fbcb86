#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <limits>
#include <taut/output/derived.hpp>

namespace taut {

double von_mises(const Mat<3>& sigma) {
  // Of differences: a small distortion under a large pressure keeps its digits.
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double difference = sigma(i, i) - sigma(j, j), twice_shear = sigma(i, j) + sigma(j, i);
    sum += 0.5 * difference * difference + 0.75 * twice_shear * twice_shear;
  }
  return std::sqrt(sum);
}

double pressure(const Mat<3>& sigma) { return -sigma.trace() / 3; }

Vec<3> principal_stresses(const Mat<3>& sigma) {
  if (!sigma.allFinite()) return Vec<3>::Constant(std::numeric_limits<double>::quiet_NaN());
  Mat<3> a = 0.5 * (sigma + sigma.transpose());
  // Jacobi's method: quadratic in the end, some five sweeps from anywhere.
  for (int sweep = 0; sweep < 30 && !(a(0, 1) == 0 && a(0, 2) == 0 && a(1, 2) == 0); ++sweep)
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        Eigen::JacobiRotation<double> rotation;
        if (!rotation.makeJacobi(a, p, q)) continue;
        a.applyOnTheLeft(p, q, rotation.adjoint());
        a.applyOnTheRight(p, q, rotation);
        a(p, q) = a(q, p) = 0;
      }
  Vec<3> values = a.diagonal();
  std::sort(values.data(), values.data() + 3, [](double x, double y) { return x > y; });
  return values;
}

}  // namespace taut
