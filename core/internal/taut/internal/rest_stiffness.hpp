#pragma once
/// \file
/// What the stable step of total Lagrangian forms is taken from: stiffnesses of the body at rest.

#include <algorithm>
#include <cmath>
#include <taut/materials/material.hpp>
#include <vector>

namespace taut {

/// An isotropic linear law of displacement gradients: P = trace tr(H) I + gradient H + transpose H^T [Pa].
struct IsotropicStiffness {
  double trace, gradient, transpose;
};

/// Highest frequency [rad/s] of a body at rest: the higher one of two laws. `eigenvalue(laws)` is the largest
/// eigenvalue of M^-1 K where `laws` has one law a material.
///
/// The continuum has no mode above that of a scalar medium of its pressure-wave modulus, in any state of no
/// faster waves, because gradients there are those of fields: the integrals of |grad u|^2 and of div^2 +
/// |curl|^2 are equal. Discrete gradients are not, the less the wider the support and the more irregular the
/// cloud, so that nearly incompressible bodies are stiffer: by up to (D lambda + 2 mu) / (lambda + 2 mu).
/// Hence the tangent at rest as well.
template <int D, class Eigenvalue>
double highest_frequency(const std::vector<const Hyperelastic<D>*>& materials, Eigenvalue&& eigenvalue) {
  std::vector<IsotropicStiffness> scalar, tangent;
  for (const auto* material : materials) {
    const double modulus = material->density() * material->wave_speed() * material->wave_speed();
    const double mu = material->parameters().mu();
    scalar.push_back({0, modulus, 0});
    tangent.push_back({modulus - 2 * mu, mu, mu});
  }
  return std::sqrt(std::max<double>(eigenvalue(scalar), eigenvalue(tangent)));
}

}  // namespace taut
