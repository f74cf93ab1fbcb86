#include <doctest/doctest.h>

#include <taut/base/error.hpp>

#include "support.hpp"

using namespace taut;

namespace {

constexpr double inf = std::numeric_limits<double>::infinity();
const MaterialParameters steel{210e9, 0.3, 7800, Plane::strain};

std::string message_of(std::string_view name, const MaterialParameters& parameters) {
  try {
    make_material<2>(name, parameters);
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

}  // namespace

TEST_CASE("every name makes a material of that name, in every dimension") {
  CHECK(material_names().size() == 5);
  for (const std::string& name : material_names()) {
    CHECK(make_material<1>(name, steel)->name() == name);
    CHECK(make_material<2>(name, steel)->name() == name);
    const auto material = make_material<3>(name, steel);
    CHECK(material->name() == name);
    CHECK(material->density() == 7800);
    CHECK(material->parameters().E == 210e9);
    CHECK((dynamic_cast<const Hypoelastic<3>*>(material.get()) != nullptr) == (name == "hypoelastic"));
    CHECK((dynamic_cast<const Hyperelastic<3>*>(material.get()) != nullptr) == (name != "hypoelastic"));
  }
}

TEST_CASE("an unknown name is answered by the valid ones") {
  const std::string message = message_of("rubber", steel);
  CHECK(message.find("\"rubber\"") != std::string::npos);
  for (const std::string& name : material_names()) CHECK(message.find(name) != std::string::npos);
}

TEST_CASE("parameters out of range are refused by name, value and range") {
  const auto with = [](double E, double nu, double density) {
    return message_of("neo_hookean", {E, nu, density, Plane::strain});
  };
  for (const double E : {0.0, -1.0, inf, std::nan("")})
    CHECK(with(E, 0.3, 1).find("E = ") != std::string::npos);
  for (const double nu : {-1.0, 0.5, 0.7, -inf, std::nan("")})
    CHECK(with(1, nu, 1).find("nu = ") != std::string::npos);
  for (const double density : {0.0, -1.0, inf, std::nan("")})
    CHECK(with(1, 0.3, density).find("density = ") != std::string::npos);
  CHECK(with(1, 0.3, 1).empty());
  CHECK(with(1, -0.99, 1).empty());
  CHECK(with(1, 0.4999, 1).empty());
  CHECK(with(-2.5, 0.3, 1).find("-2.5") != std::string::npos);
  CHECK(with(1, 0.5, 1).find("incompressible") != std::string::npos);
  CHECK(with(1, 0.6, 1).find("incompressible") == std::string::npos);
  CHECK(with(1, 0.6, 1).find("neo_hookean") != std::string::npos);
}

TEST_CASE("wave speed of the undeformed body") {
  CHECK(make_material<1>("neo_hookean", {200e9, 0.3, 8000})->wave_speed() ==
        doctest::Approx(5801).epsilon(1e-4));
  for (const std::string& name : material_names()) {
    const double c = std::sqrt((steel.lambda() + 2 * steel.mu()) / steel.density);
    CHECK(make_material<1>(name, steel)->wave_speed() == doctest::Approx(c).epsilon(1e-14));
    CHECK(make_material<2>(name, steel)->wave_speed() == doctest::Approx(c).epsilon(1e-14));
    CHECK(make_material<3>(name, steel)->wave_speed() == doctest::Approx(c).epsilon(1e-14));
    MaterialParameters sheet = steel;
    sheet.plane = Plane::stress;
    const double plate = std::sqrt(steel.E / (steel.density * (1 - steel.nu * steel.nu)));
    CHECK(make_material<2>(name, sheet)->wave_speed() == doctest::Approx(plate).epsilon(1e-14));
    // The plane means nothing in 1D and 3D.
    CHECK(make_material<1>(name, sheet)->wave_speed() == doctest::Approx(c).epsilon(1e-14));
    CHECK(make_material<3>(name, sheet)->wave_speed() == doctest::Approx(c).epsilon(1e-14));
  }
}
