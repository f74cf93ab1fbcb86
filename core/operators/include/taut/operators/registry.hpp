#pragma once
/// \file
/// The registry of gradient operators.

#include <functional>
#include <string>
#include <string_view>
#include <taut/base/parameters.hpp>
#include <taut/base/registry.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/operators/operators.hpp>
#include <vector>

namespace taut {

/// What operators are made of.
template <int D>
struct OperatorSetup {
  const Method& method;
  const Particles<D>& particles;
  const PairList& pairs;
  const Kernel& kernel;
  double smoothing_length;

  double support() const { return kernel.radius_factor() * smoothing_length; }  ///< [m]
};

struct OperatorTraits {
  int exact = 1;             ///< degree of the polynomials whose gradients are exact on any cloud
  bool areas = false;        ///< made with the boundary area vectors of the particles, acts through facets
  bool adjoint = false;      ///< stores -G_ba beside G_ab
  double support_dx = 1.5;   ///< support radius over spacing where none is given: the least that will do
  double rough_limit = 0.2;  ///< health_roughness up to which answers of `tl_displacement` with it are good
};

template <int D>
using OperatorMaker = std::function<PairOperator<D>(const OperatorSetup<D>&)>;

/// Operators by their name. New ones are one file with a function and an entry; operator_parts.hpp has what
/// they are put together from. See tests/extension/operator.cpp.
struct OperatorEntry {
  std::string name;
  std::string line;
  PerDimension<OperatorMaker> make;
  OperatorTraits traits{};
  std::vector<Parameter> parameters{};  ///< of `Method`
};

/// All operators; programs may add theirs.
Registry<OperatorEntry>& operator_registry();
/// Traits by name. \throws InputError listing the valid names.
const OperatorTraits& operator_traits(std::string_view name);

}  // namespace taut
