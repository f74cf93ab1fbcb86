#include <fmt/core.h>

#include <Eigen/LU>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/materials/material.hpp>
#include <taut/materials/models.hpp>

namespace taut {

template <int D>
Material<D>::Material(const MaterialParameters& parameters) : parameters_(parameters) {
  const double E = parameters.E, nu = parameters.nu, density = parameters.density;
  const Plane plane = parameters.plane;
  if (!(std::isfinite(E) && E > 0))
    throw InputError(fmt::format("E = {}: Young's modulus must be finite and greater than 0 Pa", E));
  if (!(nu > -1 && nu < 0.5))
    throw InputError(fmt::format(
        "nu = {}: Poisson's ratio must lie between -1 and 0.5, both excluded{}", nu,
        nu == 0.5 ? "; 0.5 needs an incompressible formulation, which this version does not have: take 0.499"
                  : ""));
  if (!(std::isfinite(density) && density > 0))
    throw InputError(fmt::format("density = {}: must be finite and greater than 0 kg/m^3", density));
  if (plane != Plane::strain && plane != Plane::stress)
    throw InputError(fmt::format("plane: the value {} of Plane has no name; valid: strain, stress",
                                 static_cast<int>(plane)));
}

template <int D>
double Material<D>::wave_speed() const {
  return std::sqrt((in_plane_lambda<D>(parameters_) + 2 * parameters_.mu()) / density());
}

template <int D>
NominalState<D> nominal_state(const Hyperelastic<D>& law, const Mat<D>& F) {
  alignas(64) double in[D * D * lanes], out[D * D * lanes];
  alignas(64) double P_lateral[2 * lanes] = {}, F_lateral[2 * lanes] = {};
  for (int c = 0; c < D * D; ++c) std::fill_n(in + c * lanes, lanes, F(c / D, c % D));
  StressBlock<D> block{lanes, lanes, in, out};
  const bool asked = D < 3 && law.has_lateral_state();
  if (asked) {
    block.P_lateral = P_lateral;
    block.F_lateral = F_lateral;
  }
  law.stress(block);

  NominalState<D> state{Mat<3>::Zero(), Vec<3>::Ones()};
  for (int c = 0; c < D * D; ++c) state.P(c / D, c % D) = out[c * lanes];
  for (int k = D; k < 3; ++k) {
    if (asked) {
      state.P(k, k) = P_lateral[(k - D) * lanes];
      state.lateral[k] = F_lateral[(k - D) * lanes];
    } else if (!is_plane_stress<D>(law.parameters())) {
      state.P(k, k) = std::numeric_limits<double>::quiet_NaN();
    }
  }
  return state;
}

template <int D>
Mat<3> Hyperelastic<D>::cauchy_stress(const Mat<D>& F) const {
  const NominalState<D> state = nominal_state(*this, F);
  Mat<3> F3 = state.lateral.asDiagonal();
  F3.template topLeftCorner<D, D>() = F;
  return state.P * F3.transpose() / F3.determinant();
}

template <int D>
Mat<3> Hypoelastic<D>::cauchy_stress(const Mat<D>& s, double rho) const {
  constexpr int S = sym_components<D>;
  constexpr int row[] = {0, 1, 2, 1, 0, 0}, column[] = {0, 1, 2, 2, 2, 1};
  const auto at = [&](int c) { return D == 2 && c == 2 ? 5 : c; };  // xx, yy, xy in 2D
  alignas(64) double in[S * lanes], out[S * lanes], density[lanes];
  for (int c = 0; c < S; ++c) std::fill_n(in + c * lanes, lanes, s(row[at(c)], column[at(c)]));
  std::fill_n(density, lanes, rho);
  RateBlock<D> block;
  block.n = lanes;
  block.stride = lanes;
  block.s = in;
  block.rho = density;
  block.sigma = out;
  stress(block);

  Mat<3> sigma = Mat<3>::Zero();
  for (int c = 0; c < S; ++c)
    sigma(row[at(c)], column[at(c)]) = sigma(column[at(c)], row[at(c)]) = out[c * lanes];
  if (!is_plane_stress<D>(this->parameters_))
    for (int k = D; k < 3; ++k) sigma(k, k) = -s.trace() / (3 - D) - (s(0, 0) - sigma(0, 0));
  return sigma;
}

#define TAUT_INSTANTIATE(D)       \
  template class Material<D>;     \
  template class Hyperelastic<D>; \
  template class Hypoelastic<D>;  \
  template NominalState<D> nominal_state(const Hyperelastic<D>&, const Mat<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
