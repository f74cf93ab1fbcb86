#pragma once
/// \file
/// What lies between two places on a lattice.

#include <array>
#include <cstdint>
#include <taut/base/types.hpp>
#include <taut/geometry/occupancy.hpp>
#include <vector>

namespace taut {

/// Whether the straight way between two sites stays in the closed union of the cells of a label: along an
/// edge or a face of cells one of those around it does. Cells beyond symmetry planes are as those before
/// them, cells beyond an end of a period as those behind the other.
template <int D>
class Visibility {
 public:
  static constexpr std::uint8_t any = 0;  ///< all labels but `nothing`
  static constexpr std::uint8_t nothing = 0;

  Visibility() = default;
  /// Labels of the cells of a lattice, x fastest. Most ways are no longer than `reach` cells along each axis.
  Visibility(const std::array<Index, D>& size, std::vector<std::uint8_t> label, Index reach);
  /// A symmetry plane across `axis` at a site's coordinate; `side` as in `MirrorMap::Plane`.
  void add_plane(int axis, Index at, int side) { planes_.push_back({axis, at, side}); }

  /// What is at one end of the lattice along the axis goes on at the other.
  void add_period(int axis) { periodic_[static_cast<std::size_t>(axis)] = true; }

  bool connects(const Site<D>& a, const Site<D>& b, std::uint8_t label) const;
  std::size_t bytes() const { return label_.size() + uniform_.size(); }

 private:
  using Cell = std::array<Index, D>;
  struct Plane {
    int axis;
    Index at;
    int side;
  };
  bool has(Cell cell, std::uint8_t label) const;
  bool is_uniform(const Site<D>& a, const Site<D>& b, std::uint8_t label) const;
  std::size_t number(const Cell& cell) const;

  Cell size_{};
  std::vector<std::uint8_t> label_;
  std::vector<std::uint8_t> uniform_;  // label of the cell and all within reach, or `nothing`
  Index reach_ = 0;
  std::vector<Plane> planes_;
  std::array<bool, D> periodic_{};
};

}  // namespace taut
