#include <taut/operators/operator_entries.hpp>
#include <taut/operators/operator_parts.hpp>

namespace taut {

namespace {

/// Weights are the volumes, and nothing is corrected.
template <int D>
PairOperator<D> make_standard(const OperatorSetup<D>& setup) {
  PairOperator<D> op = start_operator(setup, true, setup.particles.V);
  fill_radial_vectors(setup, op);
  make_matrices(setup, false, op);
  return op;
}

}  // namespace

template <int D>
PairOperator<D> make_corrected(const OperatorSetup<D>& setup) {
  PairOperator<D> op = start_operator(setup);
  fill_radial_vectors(setup, op);
  make_matrices(setup, true, op);
  return op;
}

template PairOperator<1> make_corrected<1>(const OperatorSetup<1>&);
template PairOperator<2> make_corrected<2>(const OperatorSetup<2>&);
template PairOperator<3> make_corrected<3>(const OperatorSetup<3>&);

OperatorEntry standard_entry() {
  return {.name = "standard",
          .line = "weighed by volumes, not corrected: exact inside of a lattice only",
          .make = {make_standard<1>, make_standard<2>, make_standard<3>},
          .traits = {.exact = 0}};
}

OperatorEntry corrected_entry() {
  return {
      .name = "corrected",
      .line =
          "linearly exact (Randles and Libersky 1996; Bonet and Lok 1999): accurate on lattices, does not "
          "converge on irregular clouds",
      .make = {make_corrected<1>, make_corrected<2>, make_corrected<3>}};
}

}  // namespace taut
