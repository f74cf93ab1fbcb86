#pragma once
/// \file
/// The particles of a simulation: structure of arrays, ordered for locality.

#include <algorithm>
#include <array>
#include <bit>
#include <memory>
#include <taut/base/fields.hpp>
#include <taut/base/types.hpp>
#include <taut/boundary/mirror.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/materials/material.hpp>
#include <vector>

namespace taut {

template <int D>
class PairRule;

/// Groups of particles that move as one.
struct Ties {
  std::vector<std::size_t> begin;  ///< of each group, and the end of the last; empty without any
  std::vector<Index> particles;
  bool empty() const { return particles.empty(); }
};

/// State of all particles. The first `n` are the bodies', in an order chosen for locality; mirror images of
/// symmetry planes follow up to `total`; the padding behind carries volume and velocity zero.
template <int D>
struct Particles {
  Index n = 0;
  Index total = 0;
  double dx = 0;             ///< nominal spacing [m]
  std::vector<Index> id;     ///< id[i]: the user's index of particle i
  std::vector<Index> place;  ///< place[id]: where the user's particle stands; the twin of its own material
  Vec<D> origin = Vec<D>::Zero();  ///< of the coordinates X, see `Cloud::origin` [m]
  Field X, u, v, a;                ///< reference position, displacement, velocity, acceleration; D components
  Field spacing;  ///< of each particle, for supports that grow with it [m]; empty where all have dx
  Field V;        ///< reference volume [m^D], its image's part included for particles on symmetry planes
  Field m;        ///< mass [kg] (per unit thickness in 2D, per unit area in 1D)
  Field m_flat;   ///< mass, repeated for each component: weights of norms; zero beyond n
  std::vector<Vec<D>> B;               ///< outward boundary area vectors, or empty
  std::vector<std::uint8_t> material;  ///< which of `materials` a particle is of
  std::vector<std::shared_ptr<const Material<D>>> materials;
  /// Twins: where materials meet, a particle stands once for each, with its part of the volume; or empty.
  Ties ties;
  std::shared_ptr<const PairRule<D>> rule;  ///< which pairs count; null where all do
  MirrorMap<D> mirror;
  std::vector<std::uint8_t> planes;  ///< bit d: lies on a symmetry plane across axis d; or empty
  /// Cells of the cloud, their corners as internal indices, or empty; with the part of each that is body, or
  /// empty where all are whole. A formulation that lives on cells takes them over.
  std::vector<std::array<Index, 1 << D>> cells;
  std::vector<double> cell_share;
  std::vector<std::uint8_t> cell_material;  ///< of each cell, or empty where corners tell

  /// Gives the particles of each group the mean of their vectors (accelerations), weighted by masses.
  void tie(Field& vectors) const;

  /// Where particle i stands in the reference configuration, in the user's coordinates.
  Vec<D> reference_position(Index i) const { return origin + X.template vec<D>(static_cast<std::size_t>(i)); }
  /// The support of a pair over that of particles dx apart: the larger one of the two.
  double support_scale(Index i, Index j) const {
    if (spacing.empty()) return 1;
    const double* s = spacing.component(0);
    return std::max(s[i], s[j]) / dx;
  }

  /// Of the fastest of the materials at rest [m/s].
  double wave_speed() const {
    double speed = 0;
    for (const auto& one : materials) speed = std::max(speed, one->wave_speed());
    return speed;
  }

  /// The part of V that belongs to the modelled side of the symmetry planes.
  double modelled_share(Index i) const {
    return planes.empty() ? 1 : 1.0 / (1 << std::popcount(planes[static_cast<std::size_t>(i)]));
  }

  std::size_t bytes() const {
    return X.bytes() + u.bytes() + spacing.bytes() + v.bytes() + a.bytes() + V.bytes() + m.bytes() +
           m_flat.bytes() + (id.size() + place.size()) * sizeof(Index) + B.size() * sizeof(Vec<D>) +
           material.size() + planes.size() + cells.size() * sizeof(cells[0]) +
           cell_share.size() * sizeof(double) + cell_material.size() +
           (ties.begin.size() * sizeof(std::size_t) + ties.particles.size() * sizeof(Index));
  }
};

}  // namespace taut
