// Fields of all particles in one call, and displacements at many points: what the calls for one give, bit for
// bit.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <cmath>
#include <string>
#include <taut/taut.hpp>
#include <vector>

using namespace taut;

namespace {

template <int D>
Simulation<D> stretched(const Method& method, double at = 0) {
  Vec<D> low = Vec<D>::Constant(at), high = low;
  for (int d = 0; d < D; ++d) high[d] += d == 0 ? 1 : 0.5;
  Simulation<D> s(make_cloud(box<D>(low, high), {.dx = 0.1, .jitter = 0.1}),
                  make_material<D>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}), method);
  s.set_displacement([low](const Vec<D>& X) { return Vec<D>(0.02 * (X - low)); });
  s.set_velocity([low](const Vec<D>& X) { return Vec<D>((X - low) * 0.5); });
  s.run(1e-3);
  return s;
}

template <int D>
using Dim = std::integral_constant<int, D>;

}  // namespace

TEST_CASE_TEMPLATE("fields of all particles are those of each", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const char* form : {"tl_displacement", "tl_stress_points"}) {
    const auto s = stretched<D>({.formulation = form});
    const auto same = [&](const char* name, auto&& of_one) {
      CAPTURE(std::string(name));
      const std::vector<double> all = read_field(s, name);
      const auto n = static_cast<std::size_t>(field_components(name, D));
      REQUIRE(all.size() == s.size() * n);
      bool equal = true;
      for (std::size_t i = 0; i < s.size(); ++i) {
        const auto one = of_one(i);
        std::size_t c = 0;
        for (Eigen::Index r = 0; r < one.rows(); ++r)
          for (Eigen::Index q = 0; q < one.cols(); ++q) equal = equal && all[i * n + c++] == one(r, q);
        equal = equal && c == n;
      }
      CHECK(equal);
    };
    const auto scalar = [](double value) { return Vec<1>::Constant(value).eval(); };
    same("reference_position", [&](std::size_t i) { return s.reference_position(i); });
    same("position", [&](std::size_t i) { return s.position(i); });
    same("displacement", [&](std::size_t i) { return s.displacement(i); });
    same("velocity", [&](std::size_t i) { return s.velocity(i); });
    same("mass", [&](std::size_t i) { return scalar(s.mass(i)); });
    same("cauchy_stress", [&](std::size_t i) { return s.full_cauchy_stress(i); });
    same("von_mises", [&](std::size_t i) { return scalar(von_mises(s.full_cauchy_stress(i))); });
    same("pressure", [&](std::size_t i) { return scalar(pressure(s.full_cauchy_stress(i))); });
    same("principal_stress", [&](std::size_t i) { return principal_stresses(s.full_cauchy_stress(i)); });
    same("first_piola_kirchhoff", [&](std::size_t i) { return s.first_piola_kirchhoff(i); });
    same("deformation_gradient", [&](std::size_t i) { return s.deformation_gradient(i); });
    const std::vector<double> J = read_field(s, "J");  // flags choose how products are rounded
    for (std::size_t i = 0; i < s.size(); ++i)
      CHECK(J[i] == doctest::Approx(s.deformation_gradient(i).determinant()).epsilon(1e-14));
  }
}

TEST_CASE("fields: what is asked wrongly") {
  const auto s = stretched<2>({});
  CHECK_THROWS_WITH_AS(read_field(s, "stress"), doctest::Contains("unknown field \"stress\"; valid: "),
                       InputError);
  std::vector<double> few(7);
  CHECK_THROWS_WITH_AS(read_field<2>(s, "velocity", few), doctest::Contains("there is room for 7"),
                       InputError);
  const Simulation<2> open(make_cloud(box<2>({0, 0}, {1, 1}), {.dx = 0.1}),
                           make_material<2>("neo_hookean", {.E = 1e6, .nu = 0.3, .density = 1000}), {});
  CHECK_THROWS_WITH_AS(read_field(open, "mass"), doctest::Contains("only after prepare"), InputError);
  CHECK_THROWS_AS(field_components("mass", 4), InputError);
  CHECK(field_names().size() == 12);
}

TEST_CASE_TEMPLATE("displacements at many points are those at each", Dimension, Dim<1>, Dim<2>, Dim<3>) {
  constexpr int D = Dimension::value;
  for (const double at : {0.0, -7.25, 1e6}) {
    const auto s = stretched<D>({}, at);
    std::vector<Vec<D>> points;
    for (int k = 0; k < 400; ++k) {
      Vec<D> X = Vec<D>::Constant(at);
      for (int d = 0; d < D; ++d)
        X[d] += -0.15 + (d == 0 ? 1.3 : 0.8) * std::fmod(0.618034 * (d + 1) * k + 0.1, 1.0);
      points.push_back(X);
    }
    for (std::size_t i = 0; i < s.size(); i += 3) points.push_back(s.reference_position(i));
    const std::vector<Vec<D>> all = s.displacements_at(points);
    REQUIRE(all.size() == points.size());
    bool equal = true;
    for (std::size_t k = 0; k < points.size(); ++k) equal = equal && all[k] == s.displacement_at(points[k]);
    CHECK(equal);
    points.push_back(Vec<D>::Constant(at + 5));
    CHECK_THROWS_AS(s.displacements_at(points), InputError);
    CHECK(s.displacements_at({}).empty());
  }
}
