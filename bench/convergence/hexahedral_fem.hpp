#pragma once
/// \file
/// The yardstick: trilinear hexahedral finite elements on the nodes of a lattice.

#include <array>
#include <functional>
#include <taut/base/types.hpp>
#include <taut/materials/material.hpp>
#include <vector>

namespace taut::bench {

/// Linear elastic solid of 8-node hexahedra, 2×2×2 Gauss points, row-sum lumped mass, small strain; leapfrog
/// in time (Hughes 2000, chapters 3 and 7). For comparison only: it knows fixed displacement components and
/// nothing else.
class HexahedralFem {
 public:
  /// A block of `cells` elements along each axis; node (i, j, k) is number i + (cells[0] + 1) (j + (cells[1]
  /// + 1) k), the order of a full node-centred lattice. \throws InputError for another number of nodes or an
  /// element turned inside out.
  HexahedralFem(std::vector<Vec<3>> nodes, std::array<int, 3> cells, const MaterialParameters& material);

  /// Holds component `axis` of the displacement of the selected nodes at zero.
  void fix(const std::function<bool(const Vec<3>& X)>& where, int axis);
  void set_displacement(const std::function<Vec<3>(const Vec<3>& X)>& displacement);
  void set_velocity(const std::function<Vec<3>(const Vec<3>& X)>& velocity);

  /// Advances by `duration` [s] in equal steps no longer than `max_step`, from velocities at full steps to
  /// the same. Returns the number of steps.
  int run(double duration, double max_step);

  std::size_t size() const { return X_.size(); }
  const Vec<3>& displacement(std::size_t node) const { return u_[node]; }
  const Vec<3>& velocity(std::size_t node) const { return v_[node]; }
  double mass(std::size_t node) const { return mass_[node]; }  ///< lumped [kg]
  /// Forces that the elements put on the nodes at the present displacement [N].
  std::vector<Vec<3>> internal_forces() const;
  /// Stress at the nodes [Pa]: that of the Gauss points, averaged with shape functions and volumes.
  std::vector<Mat<3>> nodal_stress() const;
  /// Stress of each element [Pa]: the mean of its Gauss points, by their volumes.
  std::vector<Mat<3>> element_stress() const;
  /// The means of the elements' corners.
  std::vector<Vec<3>> element_centres() const;

 private:
  struct Element {
    std::array<Index, 8> node;
    std::array<Eigen::Matrix<double, 3, 8>, 8> gradient;  // of the shape functions at each Gauss point
    std::array<double, 8> volume;                         // weight of each Gauss point
  };
  Mat<3> stress(const Element& e, std::size_t gauss) const;

  std::vector<Vec<3>> X_, u_, v_;
  std::vector<double> mass_;
  std::vector<Element> elements_;
  std::vector<std::array<bool, 3>> fixed_;
  MaterialParameters material_;
};

}  // namespace taut::bench
