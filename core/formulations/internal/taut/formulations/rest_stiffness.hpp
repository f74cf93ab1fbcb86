#pragma once
/// \file
/// What the stable step of total Lagrangian forms is taken from: stiffnesses of the body at rest.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <taut/base/simd.hpp>
#include <taut/materials/material.hpp>
#include <vector>

namespace taut {

/// An isotropic linear law of displacement gradients: P = trace tr(H) I + gradient H + transpose H^T [Pa].
/// Numbers are doubles, or packs where each lane has its own material.
template <class Number>
struct IsotropicStiffness {
  Number trace, gradient, transpose;

  /// P of eight gradients H, both row-major.
  template <int D>
  TAUT_INLINE void stress(const Pack (&H)[D * D], Pack (&P)[D * D]) const {
    Pack sum = H[0];
    for (int d = 1; d < D; ++d) sum += H[d * D + d];
    for (int d = 0; d < D; ++d) {
      for (int e = 0; e < D; ++e) P[d * D + e] = gradient * H[d * D + e] + transpose * H[e * D + d];
      P[d * D + d] += trace * sum;
    }
  }
  /// The same of a block.
  template <int D>
  void stress(const StressBlock<D>& block) const {
    for (int i = 0; i < block.n; i += lanes) {
      Pack H[D * D], P[D * D];
      for (std::size_t c = 0; c < D * D; ++c)
        H[c] = load((c % (D + 1) ? block.F + c * block.stride : block.H_diagonal + c / D * block.stride) + i);
      stress<D>(H, P);
      for (std::size_t c = 0; c < D * D; ++c)
        store(block.P + c * block.stride + static_cast<std::size_t>(i), P[c]);
    }
  }
};
/// One law a material.
using LawsAtRest = std::vector<IsotropicStiffness<double>>;

/// Highest frequency [rad/s] of a body at rest: the higher one of two laws. `eigenvalue(laws)` is the largest
/// eigenvalue of M^-1 K for these.
///
/// The continuum has no mode above that of a scalar medium of its pressure-wave modulus, in any state of no
/// faster waves, because gradients there are those of fields: the integrals of |grad u|^2 and of div^2 +
/// |curl|^2 are equal. Discrete gradients are not, the less the wider the support and the more irregular the
/// cloud, so that nearly incompressible bodies are stiffer: by up to (D lambda + 2 mu) / (lambda + 2 mu).
/// Hence the tangent at rest as well.
template <int D, class Eigenvalue>
double highest_frequency(const std::vector<const Hyperelastic<D>*>& materials, Eigenvalue&& eigenvalue) {
  LawsAtRest scalar, tangent;
  for (const auto* material : materials) {
    const double modulus = material->density() * material->wave_speed() * material->wave_speed();
    const double mu = material->parameters().mu();
    scalar.push_back({0, modulus, 0});
    tangent.push_back({modulus - 2 * mu, mu, mu});
  }
  return std::sqrt(std::max<double>(eigenvalue(scalar), eigenvalue(tangent)));
}

}  // namespace taut
