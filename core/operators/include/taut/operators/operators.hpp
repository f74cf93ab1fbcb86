#pragma once
/// \file
/// Discrete gradient operators on a pair list.

#include <memory>
#include <string>
#include <taut/base/fields.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/method.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

class KernelTable;

/// A slot of a slice whose pair vectors are shared. Slices that are alike but for their place keep their
/// slots once: on a lattice a pass over them so reads next to nothing but fields.
struct SharedSlot {
  Index first;  ///< contiguous: the neighbour of lane 0 less the slice's first particle; else the index block
  Index code;   ///< of the vectors
};
/// The slots of one slice, the contiguous ones first.
struct SharedSlots {
  std::int64_t begin;
  Index contiguous, count;
};

/// A gradient operator and its adjoint, in factored form: with one vector G_ab for each directed pair and one
/// matrix M_a for each particle,
///   F_a = I + [sum_b u_ab (x) G_ab] M_a^T,   u_ab = u_b - u_a,
///   f_a = sum_b (Q_a G_ab - Q_b G_ba),     Q_a = V_a P_a M_a,
/// where, for `standard` and `corrected`, G_ab = w_a w_b grad W_ab = -G_ba with the particles' weights w;
/// `standard` has w = V and M_a = I / V_a, `corrected` w = dx^D and M_a below. The vectors of `compatible`
/// and `quadratic` are not antisymmetric, so -G_ba is stored beside G_ab. Of displacements u the body is free
/// of stress at rest whatever the operator, and small strains keep their digits. The force is the exact
/// adjoint of the gradient, so linear momentum is kept to round-off.
template <int D>
struct PairOperator {
  PairPrecision precision = PairPrecision::single_precision;  ///< never `automatic`

  // Stored: slot k of lane l holds component d of G at [(k * D + d) * lanes + l], zero where the slot has no
  // pair.
  AlignedArray<float> vectors_f;
  AlignedArray<double> vectors_d;
  AlignedArray<float> adjoint_f;  ///< -G_ba, where it differs from G_ab; else empty
  AlignedArray<double> adjoint_d;
  // Shared: a slot has the vectors of block `code >> D`, laid out as above; bit d of the code is set where
  // component d is not zero in all lanes.
  AlignedArray<SharedSlots> slice_slots;  // of each slice, in `slots`
  AlignedArray<SharedSlot> slots;
  AlignedArray<double> blocks;
  // Recomputed.
  std::shared_ptr<const KernelTable> table;

  Field weight;               ///< w, one value a particle; empty where all weigh alike or vectors are kept
  double weight_product = 1;  ///< w_a w_b where all weigh alike
  Field M;    ///< D×D components, row-major; zero beyond the bodies' particles. Empty when shared
  Field sum;  ///< D components: sum_b G_ab. Empty when shared
  // Shared: slice s has M and sum of block `slice_code[s]`, D×D + D components of eight lanes each.
  AlignedArray<Index> slice_code;
  AlignedArray<double> slice_blocks;

  /// Stored G_ab of lane l in slot k.
  Vec<D> vector(std::int64_t k, int lane) const {
    Vec<D> g;
    for (int d = 0; d < D; ++d) {
      const std::size_t at = static_cast<std::size_t>((k * D + d) * lanes + lane);
      g[d] =
          precision == PairPrecision::single_precision ? static_cast<double>(vectors_f[at]) : vectors_d[at];
    }
    return g;
  }
  /// What the force is summed with where vectors are stored: -G_ba.
  const float* adjoint(const float*) const { return adjoint_f.empty() ? vectors_f.data() : adjoint_f.data(); }
  const double* adjoint(const double*) const {
    return adjoint_d.empty() ? vectors_d.data() : adjoint_d.data();
  }
  std::size_t bytes() const {
    return vectors_f.bytes() + vectors_d.bytes() + adjoint_f.bytes() + adjoint_d.bytes() +
           slice_slots.bytes() + slots.bytes() + blocks.bytes() + slice_code.bytes() + slice_blocks.bytes() +
           weight.bytes() + M.bytes() + sum.bytes();
  }
};

/// Builds the operator that `method` names, one of `operator_registry()` (registry.hpp), in the reference
/// configuration.
/// `corrected`: M_a = [sum_b G_ab (x) X_ab]^-1, so that the gradient of X is I (Randles & Libersky 1996;
/// Bonet & Lok 1999). The matrix is made from the pair vectors as they are kept, hence linear fields are
/// exact in single precision as well. Neighbours weigh alike, whatever their volumes: those next to a face of
/// a node-centred lattice, where tributary volumes are half, then see as much to both sides. At R = 1.5 dx a
/// constant stress so makes the forces of its tractions on the faces and (to 1e-5 of them) none inside; with
/// volumes as weights a held face carries 3/2 of the stress that it should. `compatible`: the least change of
/// those vectors that also closes: see taut/operators/compatible_operator.hpp. Needs boundary area vectors;
/// its vectors are stored, but where `automatic` finds those of `corrected` closed and shared.
/// `antisymmetric`: the same with vectors that stay antisymmetric, as light as `corrected`, closed but for a
/// few per cent: see taut/operators/antisymmetric_operator.hpp. `quadratic`: moving least squares, gradients
/// of quadratic fields exact at every particle (to the precision of the vectors, linear fields to round-off);
/// see taut/operators/quadratic_operator.hpp. Stored likewise; needs about R = 2.1 dx on a lattice, 2.4 dx
/// where it is jittered, and does not close, so that a constant stress makes forces next to faces and
/// wherever the cloud is irregular. \throws InputError for an unknown name (valid ones listed), missing
/// areas, vectors other than those of `standard` and `corrected` that are to be shared or recomputed, or a
/// particle whose matrix is singular: its id, its position, how many neighbours it has, and what to do.
template <int D>
PairOperator<D> make_operator(const Method& method, const Particles<D>& particles, const PairList& pairs,
                              const Kernel& kernel, double smoothing_length);
std::vector<std::string> operator_names();

}  // namespace taut
