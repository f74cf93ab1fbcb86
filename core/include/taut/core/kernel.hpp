#pragma once
/// \file
/// Smoothing kernels (methods: Lucy 1977, Monaghan 1992, Wendland 1995, Cabezon et al. 2008 and others).

#include <string>
#include <string_view>
#include <vector>

namespace taut {

/// A radial kernel W(r, h) normalised in `dimension` dimensions, zero from r = radius_factor() * h on.
class Kernel {
 public:
  /// \throws InputError listing the valid names.
  Kernel(std::string_view name, int dimension);

  std::string_view name() const;
  int dimension() const { return dimension_; }
  /// Support radius over smoothing length (kappa).
  double radius_factor() const;
  /// W [1/m^D] at distance r [m] for smoothing length h [m].
  double value(double r, double h) const;
  /// dW/dr [1/m^(D+1)].
  double derivative(double r, double h) const;
  /// The constant in W = constant h^-D shape(r/h).
  double constant() const { return constant_; }

  static std::vector<std::string> names();

 private:
  int shape_ = 0;
  int dimension_ = 0;
  double constant_ = 0;
};

}  // namespace taut
