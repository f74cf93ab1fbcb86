#pragma once
/// \file
/// What the files of the materials share with the registry and with each other. Private to the library.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <taut/materials/material.hpp>
#include <taut/materials/registry.hpp>

namespace taut {

template <int D>
bool is_plane_stress(const MaterialParameters& parameters) {
  return D == 2 && parameters.plane == Plane::stress;
}

/// The first Lamé constant of the in-plane law; 2 lambda mu / (lambda + 2 mu) where the third stress
/// vanishes.
template <int D>
double in_plane_lambda(const MaterialParameters& parameters) {
  const double lambda = parameters.lambda(), mu = parameters.mu();
  return is_plane_stress<D>(parameters) ? 2 * lambda * mu / (lambda + 2 * mu) : lambda;
}

/// What a law says of one deformation gradient, made three-dimensional: P, and the stretches along the axes
/// that the body does not have (1 along the others). See `Hyperelastic::cauchy_stress` for what is unknown.
template <int D>
struct NominalState {
  Mat<3> P;
  Vec<3> lateral;
};
template <int D>
NominalState<D> nominal_state(const Hyperelastic<D>& law, const Mat<D>& F);

/// Bounds of the deformation, made consistent: D stretches within [min, max] leave J within [min^D, max^D].
template <int D>
struct StretchRange {
  double min, max, J_min, J_max;
  StretchRange(double min_, double max_, double J_min_, double J_max_)
      : min(min_),
        max(max_),
        J_min(std::max(J_min_, std::pow(std::max(min_, 0.0), D))),
        J_max(std::min(J_max_, std::pow(max_, D))) {}
};

/// Largest and least trace of the Green strain.
template <int D>
double trace_of_green_strain(double stretch) {
  return 0.5 * D * (stretch * stretch - 1);
}

}  // namespace taut
