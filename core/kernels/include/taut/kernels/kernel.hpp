#pragma once
/// \file
/// Smoothing kernels.

#include <string>
#include <string_view>
#include <vector>

namespace taut {

struct KernelEntry;

/// A radial kernel W(r, h) = constant() h^-D shape(r / h), normalised in D = `dimension` dimensions and
/// exactly zero from r = radius_factor() h on: one of `kernel_registry()` (registry.hpp). Cheap to make and
/// to copy: the constants are computed once for all.
class Kernel {
 public:
  /// \throws InputError for an unknown name, listing the valid ones, or a dimension that is not 1, 2 or 3.
  Kernel(std::string_view name, int dimension);

  std::string_view name() const;
  int dimension() const { return dimension_; }
  /// Support radius over smoothing length (kappa).
  double radius_factor() const;
  /// W [1/m^D] at distance r >= 0 [m] for smoothing length h > 0 [m].
  double value(double r, double h) const;
  /// dW/dr [1/m^(D+1)]; at r = 0 the limit from r > 0, which is zero for every kernel but `quadratic`.
  double derivative(double r, double h) const;
  /// The constant in W = constant h^-D shape(r/h).
  double constant() const { return constant_; }

  /// The valid names, in the order in which tables and charts list them.
  static std::vector<std::string> names();

 private:
  const KernelEntry* entry_ = nullptr;
  int dimension_ = 0;
  double constant_ = 0;
};

}  // namespace taut
