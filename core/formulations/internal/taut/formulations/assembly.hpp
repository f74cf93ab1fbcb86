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

/// Orders the particles of a cloud for locality and lays out their state, mirror images within `reach` [m] of
/// the planes, which are given in the cloud's own coordinates, behind them. `material[id]` indexes
/// `materials`. Where `interfaces` are given masses are those of the parts that materials have of particles,
/// and with `twins` a particle of several parts becomes one for each, tied together. \throws InputError for a
/// cloud without particles, volumes that are not positive, or a plane that cuts the body.
template <int D>
Particles<D> assemble(const Cloud<D>& cloud, std::vector<std::shared_ptr<const Material<D>>> materials,
                      const std::vector<std::uint8_t>& material,
                      const std::vector<typename MirrorMap<D>::Plane>& planes, double reach,
                      const Interfaces<D>* interfaces = nullptr, bool twins = false);

}  // namespace taut
