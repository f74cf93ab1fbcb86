#pragma once
/// \file
/// The registry of smoothing kernels.

#include <array>
#include <string>
#include <taut/base/registry.hpp>

namespace taut {

/// A kernel as functions of q = r / h. A new one is an entry here; see tests/extension/kernel.cpp.
struct KernelEntry {
  std::string name;
  std::string line;           ///< what it is, and its source
  double radius_factor = 2;   ///< support radius over smoothing length (kappa)
  double (*shape)(double q);  ///< within [0, kappa), not normalised; smooth but for finitely many points
  double (*slope)(double q);  ///< its derivative
  bool cut_off = false;       ///< whether it jumps to zero at the edge of its support
  /// Of W = constant h^-D shape, in 1D, 2D and 3D; where they are zero, quadrature finds them when the entry
  /// is added.
  std::array<double, 3> constants{};
};

/// All kernels. Add by `add_kernel`.
const Registry<KernelEntry>& kernel_registry();
/// \throws InputError as `Registry::add`, and for a shape that has no positive integral.
void add_kernel(KernelEntry entry);

}  // namespace taut
