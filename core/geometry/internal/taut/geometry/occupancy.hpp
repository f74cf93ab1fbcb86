#pragma once
/// \file
/// Which cells of a lattice are body, and where its particles sit among them.

#include <array>
#include <cstdint>
#include <taut/base/types.hpp>
#include <taut/geometry/geometry.hpp>
#include <vector>

namespace taut {

/// A place on a lattice, in half cells from its lowest corner: cells end at even numbers.
template <int D>
using Site = std::array<Index, D>;

/// What `make_cloud` filled. Says nothing of positions, so that clouds may be moved, turned and bent.
template <int D>
struct Occupancy {
  bool nodes = true;                ///< particles on the corners of cells, else in their middle
  std::array<Index, D> size{};      ///< cells along each axis, layers included
  Vec<D> spacing;                   ///< edges of a cell [m]
  std::uint16_t whole = 1;          ///< fill of a cell all of which is body
  bool gapless = true;              ///< every cell has a part of the body
  std::vector<std::uint16_t> fill;  ///< of each cell, x fastest; empty where all are whole
  std::vector<Index> sites;  ///< numbers of the particles' sites, x fastest; empty where every site has one
  std::size_t particles = 0;

  std::size_t cells() const {
    std::size_t n = 1;
    for (const Index s : size) n *= static_cast<std::size_t>(s);
    return n;
  }
  std::uint16_t filled(std::size_t cell) const { return fill.empty() ? whole : fill[cell]; }
  /// Of a particle, by the number that it has in the cloud.
  Site<D> site(std::size_t id) const {
    Index rest = sites.empty() ? static_cast<Index>(id) : sites[id];
    Site<D> at;
    for (std::size_t d = 0; d < D; ++d) {
      const Index count = size[d] + (nodes ? 1 : 0);
      at[d] = 2 * (rest % count) + (nodes ? 0 : 1);
      rest /= count;
    }
    return at;
  }
};

/// The lattice of a cloud, or null where it has none, or where particles have come, gone or changed places
/// since.
template <int D>
const Occupancy<D>* lattice_of(const Cloud<D>& cloud);

}  // namespace taut
