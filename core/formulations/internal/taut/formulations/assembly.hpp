#pragma once
/// \file
/// From clouds to ordered particles.

#include <memory>
#include <taut/boundary/mirror.hpp>
#include <taut/formulations/pairs_at_rest.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/materials/material.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/method.hpp>
#include <taut/particles/interfaces.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

/// How often each particle of the cloud stands for itself: 2^k for one on k symmetry planes, whose volume is
/// half on each side.
template <int D>
std::vector<double> multiplicity(const Cloud<D>& cloud,
                                 const std::vector<typename MirrorMap<D>::Plane>& planes);

/// Where a body ends and yet goes on, in the coordinates of its cloud.
template <int D>
struct Surroundings {
  std::vector<typename MirrorMap<D>::Plane> planes;
  std::vector<typename MirrorMap<D>::Period> periods;
  double reach = 0;     ///< how far beyond planes and ends of periods images are wanted [m]
  bool follow = false;  ///< images follow the particles: leaves room for more of them
};

/// Orders the particles of a cloud for locality and lays out their state, images behind them. Nodes of cells
/// at the two ends of a period are tied together. `material[id]` indexes
/// `materials`. Where `interfaces` are given masses are those of the parts that materials have of particles,
/// and with `twins` a particle of several parts becomes one for each, tied together. \throws InputError for a
/// cloud without particles, volumes that are not positive, a plane that cuts the body, or a period that it
/// does not fit.
template <int D>
Particles<D> assemble(const Cloud<D>& cloud, std::vector<std::shared_ptr<const Material<D>>> materials,
                      const std::vector<std::uint8_t>& material, const Surroundings<D>& around,
                      const Interfaces<D>* interfaces = nullptr, bool twins = false);

}  // namespace taut
