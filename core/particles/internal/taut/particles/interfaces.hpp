#pragma once
/// \file
/// Bodies of several materials on node-centred lattices: the parts that each material has of a particle.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <taut/base/types.hpp>
#include <taut/geometry/geometry.hpp>
#include <vector>

namespace taut {

/// What a material has of a particle.
template <int D>
struct MaterialPart {
  std::uint8_t material;
  double V;  ///< [m^D]
  Vec<D> B;  ///< outward area vector of the material's cells, interfaces with others included [m^(D-1)]
};

/// Materials of cells. A material is where its cells are; a particle between cells of several carries a part
/// for each, in proportion to the cells around it, so that volumes and masses are those of the cells. Parts
/// have area vectors as bodies of their own would: sum B = 0 and sum X (x) B = V I hold for each material.
template <int D>
class Interfaces {
 public:
  /// All cells are of material 0. Needs `Interfaces<D>::known(cloud)`.
  explicit Interfaces(const Cloud<D>& cloud);
  /// Whether a cloud is one of a node-centred lattice, whose cells are known.
  static bool known(const Cloud<D>& cloud);

  /// Gives the cells to a material whose centres, the means of their corners, lie where `where` holds.
  void assign(const Cloud<D>& cloud, const std::function<bool(const Vec<D>&)>& where, std::uint8_t material);
  /// False where a material was given particles but not one cell: then it is one of whole particles.
  bool resolved() const { return resolved_; }

  std::span<const MaterialPart<D>> parts(std::size_t id) const {
    return {parts_.data() + begin_[id], parts_.data() + begin_[id + 1]};
  }
  /// Materials of the cells with a part of the body, in the order of `Cloud::cells`.
  const std::vector<std::uint8_t>& cell_material() const { return material_; }
  /// Numbers of these cells on the lattice.
  const std::vector<Index>& cells() const { return cells_; }

  /// Puts particles on interfaces that jitter has moved back on the lattice: interfaces are faces of the
  /// materials, and jitter leaves faces as they are.
  void straighten(Cloud<D>& cloud) const;

 private:
  void share_out(const Cloud<D>& cloud);

  std::vector<Index> cells_;
  std::vector<std::array<Index, 1 << D>> corners_;
  std::vector<std::uint8_t> material_;
  std::vector<std::size_t> begin_;
  std::vector<MaterialPart<D>> parts_;  // of each particle, by material
  bool resolved_ = true;
};

}  // namespace taut
