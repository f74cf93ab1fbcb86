#pragma once
/// \file
/// The dense-matrix algorithm 5.2 of a thesis (University of Cape Town; E. B. Ismail and B. D. Reddy,
/// "Smoothed particle hydrodynamics for nonlinear solid mechanics", is bound into it), header only: tests
/// compare the engine with it, taut-scaling their run times.

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <taut/geometry/geometry.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/materials/material.hpp>
#include <vector>

namespace taut::bench {

/// A neo-Hookean body whose SPH sums are products with N×N matrices; time goes by central differences.
template <int D>
class DenseSteps {
 public:
  enum class Form {
    as_printed,  ///< grad f = X f, div P = X P: right where a rim as wide as the support is held
    conjugate  ///< grad f = sum (f_b - f_a) g_ab and its adjoint (the `standard` operator): right everywhere
  };
  /// A value of D components for each particle. One product of a matrix serves all of them.
  using Columns = Eigen::Matrix<double, Eigen::Dynamic, D>;

  /// At rest, displaced by `displacement` [m]; `held` particles (or none) stay at zero from the first step
  /// on.
  DenseSteps(const Cloud<D>& cloud, const Kernel& kernel, double h, const MaterialParameters& material,
             const std::vector<Vec<D>>& displacement, Form form, std::vector<bool> held = {})
      : mu_(material.mu()),
        lambda_(material.lambda()),
        rho_(material.density),
        form_(form),
        held_(std::move(held)) {
    const auto n = static_cast<Eigen::Index>(cloud.size());
    for (auto& matrix : X_) matrix = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index q = 0; q < n; ++q)
      for (Eigen::Index p = 0; p < n; ++p) {
        if (p == q) continue;
        const auto i = static_cast<std::size_t>(p), j = static_cast<std::size_t>(q);
        const Vec<D> r = cloud.X[i] - cloud.X[j];
        const double slope = kernel.derivative(r.norm(), h) / r.norm() * cloud.V[j];
        for (int d = 0; d < D; ++d) X_[axis(d)](p, q) = slope * r[d];
      }
    for (int d = 0; d < D; ++d) row_sum_[axis(d)] = X_[axis(d)].rowwise().sum();
    u_.resize(n, D);
    for (Eigen::Index i = 0; i < n; ++i) u_.row(i) = displacement[static_cast<std::size_t>(i)];
  }

  /// [m/s^2] of the present displacements.
  Columns accelerations() const {
    const Eigen::Index n = u_.rows();
    std::array<Columns, D> P;  // column j of the stress; first of the displacement gradient
    for (int j = 0; j < D; ++j) {
      P[axis(j)].noalias() = X_[axis(j)] * u_;
      if (form_ == Form::conjugate) P[axis(j)] -= row_sum_[axis(j)].asDiagonal() * u_;
    }
    for (Eigen::Index a = 0; a < n; ++a) {
      Mat<D> F = Mat<D>::Identity();
      for (int j = 0; j < D; ++j) F.col(j) += P[axis(j)].row(a);
      const Mat<D> inverse_transpose = F.inverse().transpose();
      const Mat<D> stress =
          mu_ * (F - inverse_transpose) + lambda_ * std::log(F.determinant()) * inverse_transpose;
      for (int j = 0; j < D; ++j) P[axis(j)].row(a) = stress.col(j);
    }
    Columns a = Columns::Zero(n, D);
    for (int j = 0; j < D; ++j) {
      a.noalias() += X_[axis(j)] * P[axis(j)];
      if (form_ == Form::conjugate) a += row_sum_[axis(j)].asDiagonal() * P[axis(j)];
    }
    return a / rho_;
  }

  void step(double dt) {
    const Columns a = accelerations();
    const Columns next =
        old_.size() == 0 ? Columns(u_ + dt * dt / 2 * a) : Columns(dt * dt * a + 2 * u_ - old_);
    old_ = u_;
    u_ = next;
    for (std::size_t p = 0; p < held_.size(); ++p)
      if (held_[p]) u_.row(static_cast<Eigen::Index>(p)).setZero();
  }

  Vec<D> displacement(std::size_t id) const { return u_.row(static_cast<Eigen::Index>(id)); }
  std::size_t bytes() const {
    return sizeof(double) * static_cast<std::size_t>(D * X_[0].size() + D * u_.rows() + 2 * u_.size());
  }

 private:
  static constexpr std::size_t axis(int d) { return static_cast<std::size_t>(d); }

  std::array<Eigen::MatrixXd, D> X_;  // X_[d](p, q) = V_q dW_pq / dx_d
  std::array<Eigen::VectorXd, D> row_sum_;
  double mu_, lambda_, rho_;
  Form form_;
  std::vector<bool> held_;
  Columns u_, old_;
};

}  // namespace taut::bench
