// Operators: pair vectors, and the matrices that make linear fields exact.
#include "parts.hpp"

namespace {

/// As `corrected`, but neighbours weigh by their volumes.
template <int D>
taut::PairOperator<D> make(const taut::OperatorSetup<D>& setup) {
  auto op = taut::start_operator(setup, true, setup.particles.V);
  taut::fill_radial_vectors(setup, op);
  taut::make_matrices(setup, true, op);
  return op;
}

}  // namespace

taut::OperatorEntry volume_corrected() {
  return {.name = "volume_corrected",
          .line = "linearly exact, neighbours weighed by their volumes",
          .make = {make<1>, make<2>, make<3>}};
}
