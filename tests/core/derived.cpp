// Scalars of a stress: von Mises, pressure, principal stresses.
#include <doctest/doctest.h>

#include <limits>
#include <materials/support.hpp>
#include <taut/output/derived.hpp>

using namespace taut;

namespace {
Mat<3> diagonal(double a, double b, double c) { return Vec<3>(a, b, c).asDiagonal(); }
}  // namespace

TEST_CASE("von Mises stress and pressure in closed form") {
  CHECK(von_mises(diagonal(3e6, 0, 0)) == doctest::Approx(3e6).epsilon(1e-15));
  CHECK(von_mises(diagonal(0, -3e6, 0)) == doctest::Approx(3e6).epsilon(1e-15));
  CHECK(von_mises(diagonal(5e9, 5e9, 5e9)) == 0);
  CHECK(von_mises(diagonal(1e9 + 1, 1e9, 1e9)) == doctest::Approx(1).epsilon(1e-15));  // under pressure
  for (int i = 0; i < 3; ++i) {
    Mat<3> shear = Mat<3>::Zero();
    shear(i, (i + 1) % 3) = shear((i + 1) % 3, i) = -2e5;
    CHECK(von_mises(shear) == doctest::Approx(std::sqrt(3.0) * 2e5).epsilon(1e-15));
    CHECK(pressure(shear) == 0);
  }
  CHECK(pressure(diagonal(-1, -2, -6)) == 3);
}

TEST_CASE("principal stresses: eigenvalues, largest first") {
  test::Random random(13);
  for (int i = 0; i < 100; ++i) {
    const Mat<3> R = random.rotation<3>();
    Vec<3> values(random(-1, 1), random(-1, 1), random(-1, 1));
    if (i % 3 == 0) values[1] = values[0];         // two alike
    if (i % 5 == 0) values[2] = 1e-9 * values[1];  // of very different size
    const Mat<3> sigma = R * values.asDiagonal() * R.transpose();
    std::sort(values.data(), values.data() + 3, std::greater<>());
    CHECK((principal_stresses(sigma) - values).cwiseAbs().maxCoeff() < 4e-15);
    CHECK(von_mises(sigma) == doctest::Approx(von_mises(values.asDiagonal())).epsilon(1e-13));
  }
  CHECK(principal_stresses(diagonal(-3, 7, 2)) == Vec<3>(7, 2, -3));
  CHECK(principal_stresses(Mat<3>::Zero()) == Vec<3>::Zero());
  Mat<3> broken = Mat<3>::Identity();
  broken(0, 1) = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(principal_stresses(broken)[0]));
}
