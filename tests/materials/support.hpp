#pragma once
// Shared by the tests of the materials: random deformations, and materials evaluated one deformation at a
// time.

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <taut/base/fields.hpp>
#include <taut/materials/material.hpp>
#include <vector>

namespace taut::test {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  /// Uniform; the same on every standard library.
  double operator()(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_() >> 11) * 0x1p-53);
  }
  template <int D>
  Mat<D> matrix(double size) {
    Mat<D> m;
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) m(i, j) = (*this)(-size, size);
    return m;
  }
  template <int D>
  Vec<D> direction() {
    for (;;) {
      Vec<D> v;
      for (int i = 0; i < D; ++i) v[i] = (*this)(-1, 1);
      if (v.norm() > 0.1) return v.normalized();
    }
  }
  template <int D>
  Mat<D> rotation() {
    if constexpr (D == 1)
      return Mat<1>::Identity();
    else if constexpr (D == 2)
      return Eigen::Rotation2Dd((*this)(-3.2, 3.2)).toRotationMatrix();
    else
      return Eigen::AngleAxisd((*this)(-3.2, 3.2), direction<3>()).toRotationMatrix();
  }
  template <int D>
  Vec<D> stretches(double low, double high) {
    Vec<D> s;
    for (int i = 0; i < D; ++i) s[i] = (*this)(low, high);
    return s;
  }
  /// R V diag(stretches) V^T.
  template <int D>
  Mat<D> deformation(const Vec<D>& stretches) {
    const Mat<D> V = rotation<D>();
    return rotation<D>() * V * stretches.asDiagonal() * V.transpose();
  }
  /// Each stretch drawn from [low, high].
  template <int D>
  Mat<D> deformation(double low, double high) {
    return deformation<D>(stretches<D>(low, high));
  }

 private:
  std::mt19937_64 engine_;
};

template <int D>
struct Evaluation {
  Mat<D> P;
  double energy;
};

template <int D>
std::shared_ptr<const Hyperelastic<D>> hyperelastic(std::string_view name,
                                                    const MaterialParameters& parameters) {
  return std::dynamic_pointer_cast<const Hyperelastic<D>>(make_material<D>(name, parameters));
}

/// P (and the energy, for laws that have one) at F.
template <int D>
Evaluation<D> evaluate(const Hyperelastic<D>& material, const Mat<D>& F) {
  Field in(lanes, D * D), out(lanes, D * D), energy(lanes, 1);
  for (int p = 0; p < lanes; ++p) in.set_mat<D>(p, F);
  material.stress(
      {lanes, in.stride(), in.data(), out.data(), material.has_energy() ? energy.data() : nullptr});
  return {out.mat<D>(3), energy.data()[3]};
}

template <int D>
Mat<D> stress(const Hyperelastic<D>& material, const Mat<D>& F) {
  return evaluate(material, F).P;
}

struct Mode {
  int dimension;
  Plane plane;
};

/// Calls f(std::integral_constant<int, D>, plane) for 1D, plane strain, plane stress and 3D.
template <class F>
void for_each_mode(F f) {
  f(std::integral_constant<int, 1>{}, Plane::strain);
  f(std::integral_constant<int, 2>{}, Plane::strain);
  f(std::integral_constant<int, 2>{}, Plane::stress);
  f(std::integral_constant<int, 3>{}, Plane::strain);
}

/// Largest eigenvalue by magnitude, complex ones too: Gelfand's formula |A^n|^(1/n) with n = 2^16.
template <int D>
double spectral_radius(Mat<D> A) {
  double logarithm = 0, weight = 1;
  for (int i = 0; i < 16; ++i) {
    const double norm = A.norm();
    if (norm == 0) return 0;
    logarithm += weight * std::log(norm);
    weight /= 2;
    A = (A / norm).eval();
    A = (A * A).eval();
  }
  return std::exp(logarithm);
}

inline const std::vector<std::string>& hyperelastic_names() {
  static const std::vector<std::string> names = {"linear_elastic", "st_venant_kirchhoff", "corotated_svk",
                                                 "neo_hookean"};
  return names;
}

}  // namespace taut::test
