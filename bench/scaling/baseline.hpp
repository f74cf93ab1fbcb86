#pragma once
/// \file
/// The total Lagrangian step as it is written elsewhere: what taut's own is compared with.

#include <memory>
#include <string_view>
#include <taut/geometry/geometry.hpp>
#include <taut/materials/material.hpp>
#include <taut/operators/method.hpp>
#include <vector>

namespace taut::bench {

/// A free body under the `corrected` operator (see PairOperator) with pair vectors in double precision, in
/// leapfrog steps whose velocities live at half steps: the same sums as taut's `tl_displacement`, in other
/// data structures.
class Baseline {
 public:
  virtual ~Baseline() = default;
  /// One step of dt [s]: kick, drift and the accelerations of the new state.
  virtual void step(double dt, int threads) = 0;
  /// Accelerations of the present state [m/s^2], in the order of the cloud.
  virtual std::vector<Vec<3>> accelerations() const = 0;
  virtual std::size_t bytes() const = 0;
};

/// Body, operator and start of a baseline. Particles stand in taut's order of locality.
struct BaselineBody {
  const Cloud<3>& cloud;
  const Method& method;
  std::shared_ptr<const Hyperelastic<3>> material;
};

/// The plain way: neighbours in compressed rows with a kernel gradient each, small Eigen vectors and matrices
/// a particle, loops over particles in OpenMP (so SPHinXsys, Zhang et al., Comput. Phys. Commun. 267, 2021).
std::unique_ptr<Baseline> make_csr_gather(const BaselineBody& body);
/// Each sum over pairs is a product of one of three row-major sparse matrices, N_e(a, b) = component e of
/// G_ab, with three columns; Eigen's threads.
std::unique_ptr<Baseline> make_eigen_sparse(const BaselineBody& body);

/// What both are made of: pairs in compressed rows, in taut's order.
struct CompressedPairs {
  std::vector<Index> id;          ///< id[i]: place in the cloud of particle i
  std::vector<std::int64_t> row;  ///< pairs of particle i: row[i] … row[i + 1]
  std::vector<Index> neighbour;
  std::vector<Vec<3>> gradient;  ///< G_ab = w_a w_b grad W_ab
  std::vector<Mat<3>> M;         ///< [sum_b G_ab (x) X_ab]^-1
};
CompressedPairs compressed_pairs(const Cloud<3>& cloud, const Method& method);

}  // namespace taut::bench
