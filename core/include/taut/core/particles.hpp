#pragma once
/// \file
/// The particles of a simulation: structure of arrays, ordered for locality.

#include <memory>
#include <taut/boundary/mirror.hpp>
#include <taut/core/fields.hpp>
#include <taut/core/geometry.hpp>
#include <taut/core/types.hpp>
#include <taut/materials/material.hpp>
#include <vector>

namespace taut {

/// State of all particles. The first `n` are the bodies', in an order chosen for locality; mirror images of symmetry
/// planes follow up to `total`; the padding behind carries volume and velocity zero.
template <int D>
struct Particles {
  Index n = 0;
  Index total = 0;
  double dx = 0;                 ///< nominal spacing [m]
  std::vector<Index> id;         ///< id[i]: the user's index of particle i
  std::vector<Index> place;      ///< place[id]: where the user's particle stands
  Field X, x, v, a;              ///< reference and current position, velocity, acceleration; D components
  Field V;                       ///< reference volume [m^D]
  Field m;                       ///< mass [kg] (per unit thickness in 2D, per unit area in 1D)
  Field m_flat;                  ///< mass, repeated for each component: weights of norms; zero beyond n
  std::vector<Vec<D>> B;         ///< outward boundary area vectors, or empty
  std::vector<std::uint8_t> material;                            ///< which of `materials` a particle is of
  std::vector<std::shared_ptr<const Material<D>>> materials;
  MirrorMap<D> mirror;

  std::size_t bytes() const {
    return X.bytes() + x.bytes() + v.bytes() + a.bytes() + V.bytes() + m.bytes() + m_flat.bytes() +
           (id.size() + place.size()) * sizeof(Index) + B.size() * sizeof(Vec<D>) + material.size();
  }
};

}  // namespace taut
