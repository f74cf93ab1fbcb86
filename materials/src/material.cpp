#include <fmt/core.h>

#include <cmath>
#include <taut/core/error.hpp>
#include <taut/materials/material.hpp>

#include "models.hpp"

namespace taut {

template <int D>
Material<D>::Material(const MaterialParameters& parameters) : parameters_(parameters) {
  const auto [E, nu, density, plane] = parameters;
  if (!(std::isfinite(E) && E > 0))
    throw InputError(fmt::format("E = {}: Young's modulus must be finite and greater than 0 Pa", E));
  if (!(nu > -1 && nu < 0.5))
    throw InputError(fmt::format(
        "nu = {}: Poisson's ratio must lie between -1 and 0.5, both excluded{}", nu,
        nu == 0.5 ? "; 0.5 needs an incompressible formulation, which this version does not have: take 0.499"
                  : ""));
  if (!(std::isfinite(density) && density > 0))
    throw InputError(fmt::format("density = {}: must be finite and greater than 0 kg/m^3", density));
}

template <int D>
double Material<D>::wave_speed() const {
  return std::sqrt((in_plane_lambda<D>(parameters_) + 2 * parameters_.mu()) / density());
}

template class Material<1>;
template class Material<2>;
template class Material<3>;

}  // namespace taut
