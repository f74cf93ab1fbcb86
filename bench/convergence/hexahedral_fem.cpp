#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <convergence/hexahedral_fem.hpp>
#include <taut/base/error.hpp>

namespace taut::bench {
namespace {

/// Corner c of the parent cube [-1, 1]^3.
Vec<3> corner(std::size_t c) { return {c & 1 ? 1.0 : -1.0, c & 2 ? 1.0 : -1.0, c & 4 ? 1.0 : -1.0}; }

double shape(std::size_t c, const Vec<3>& xi) { return (1 + corner(c).array() * xi.array()).prod() / 8; }

Vec<3> shape_gradient(std::size_t c, const Vec<3>& xi) {
  const Eigen::Array3d s = corner(c).array(), f = 1 + s * xi.array();
  return Vec<3>(s[0] * f[1] * f[2], f[0] * s[1] * f[2], f[0] * f[1] * s[2]) / 8;
}

Vec<3> gauss_point(std::size_t q) { return corner(q) / std::sqrt(3.0); }

}  // namespace

HexahedralFem::HexahedralFem(std::vector<Vec<3>> nodes, std::array<int, 3> cells,
                             const MaterialParameters& material)
    : X_(std::move(nodes)), material_(material) {
  const std::array<Index, 3> n = {cells[0] + 1, cells[1] + 1, cells[2] + 1};
  if (X_.size() !=
      static_cast<std::size_t>(n[0]) * static_cast<std::size_t>(n[1]) * static_cast<std::size_t>(n[2]))
    throw InputError(fmt::format("hexahedra: {} x {} x {} cells need {} nodes, not {}", cells[0], cells[1],
                                 cells[2], n[0] * n[1] * n[2], X_.size()));
  u_.assign(size(), Vec<3>::Zero());
  v_ = u_;
  mass_.assign(size(), 0);
  fixed_.assign(size(), {});
  for (int k = 0; k < cells[2]; ++k)
    for (int j = 0; j < cells[1]; ++j)
      for (int i = 0; i < cells[0]; ++i) {
        Element e;
        for (std::size_t c = 0; c < 8; ++c)
          e.node[c] = i + (c & 1) +
                      n[0] * (j + static_cast<Index>(c >> 1 & 1) + n[1] * (k + static_cast<Index>(c >> 2)));
        for (std::size_t q = 0; q < 8; ++q) {
          Mat<3> jacobian = Mat<3>::Zero();  // dX / dxi
          for (std::size_t c = 0; c < 8; ++c)
            jacobian +=
                X_[static_cast<std::size_t>(e.node[c])] * shape_gradient(c, gauss_point(q)).transpose();
          e.volume[q] = jacobian.determinant();
          if (!(e.volume[q] > 0))
            throw InputError(fmt::format("hexahedra: element ({}, {}, {}) is turned inside out", i, j, k));
          const Mat<3> to_parent = jacobian.inverse().transpose();
          for (std::size_t c = 0; c < 8; ++c) {
            e.gradient[q].col(static_cast<Eigen::Index>(c)) = to_parent * shape_gradient(c, gauss_point(q));
            mass_[static_cast<std::size_t>(e.node[c])] +=
                material.density * e.volume[q] * shape(c, gauss_point(q));
          }
        }
        elements_.push_back(e);
      }
}

void HexahedralFem::fix(const std::function<bool(const Vec<3>&)>& where, int axis) {
  for (std::size_t i = 0; i < size(); ++i)
    if (where(X_[i])) fixed_[i][static_cast<std::size_t>(axis)] = true;
}

void HexahedralFem::set_displacement(const std::function<Vec<3>(const Vec<3>&)>& displacement) {
  for (std::size_t i = 0; i < size(); ++i) u_[i] = displacement(X_[i]);
}

void HexahedralFem::set_velocity(const std::function<Vec<3>(const Vec<3>&)>& velocity) {
  for (std::size_t i = 0; i < size(); ++i)
    for (int d = 0; d < 3; ++d) v_[i][d] = fixed_[i][static_cast<std::size_t>(d)] ? 0 : velocity(X_[i])[d];
}

Mat<3> HexahedralFem::stress(const Element& e, std::size_t gauss) const {
  Mat<3> gradient = Mat<3>::Zero();
  for (std::size_t c = 0; c < 8; ++c)
    gradient += u_[static_cast<std::size_t>(e.node[c])] *
                e.gradient[gauss].col(static_cast<Eigen::Index>(c)).transpose();
  return material_.lambda() * gradient.trace() * Mat<3>::Identity() +
         material_.mu() * (gradient + gradient.transpose());
}

std::vector<Vec<3>> HexahedralFem::internal_forces() const {
  std::vector<Vec<3>> force(size(), Vec<3>::Zero());
  for (const Element& e : elements_)
    for (std::size_t q = 0; q < 8; ++q) {
      const Mat<3> scaled = -e.volume[q] * stress(e, q);
      for (std::size_t c = 0; c < 8; ++c)
        force[static_cast<std::size_t>(e.node[c])] +=
            scaled * e.gradient[q].col(static_cast<Eigen::Index>(c));
    }
  return force;
}

int HexahedralFem::run(double duration, double max_step) {
  const int steps = static_cast<int>(std::ceil(duration / max_step));
  const double dt = duration / steps;
  const auto kick = [&](double h) {
    const std::vector<Vec<3>> force = internal_forces();
    for (std::size_t i = 0; i < size(); ++i)
      for (int d = 0; d < 3; ++d)
        v_[i][d] = fixed_[i][static_cast<std::size_t>(d)] ? 0 : v_[i][d] + h * force[i][d] / mass_[i];
  };
  kick(dt / 2);
  for (int step = 1; step <= steps; ++step) {
    for (std::size_t i = 0; i < size(); ++i) u_[i] += dt * v_[i];
    kick(step < steps ? dt : dt / 2);
  }
  return steps;
}

std::vector<Mat<3>> HexahedralFem::nodal_stress() const {
  std::vector<Mat<3>> sum(size(), Mat<3>::Zero());
  for (const Element& e : elements_)
    for (std::size_t q = 0; q < 8; ++q) {
      const Mat<3> sigma = stress(e, q);
      for (std::size_t c = 0; c < 8; ++c)
        sum[static_cast<std::size_t>(e.node[c])] += e.volume[q] * shape(c, gauss_point(q)) * sigma;
    }
  for (std::size_t i = 0; i < size(); ++i) sum[i] *= material_.density / mass_[i];
  return sum;
}

std::vector<Mat<3>> HexahedralFem::element_stress() const {
  std::vector<Mat<3>> mean;
  for (const Element& e : elements_) {
    Mat<3> sum = Mat<3>::Zero();
    double volume = 0;
    for (std::size_t q = 0; q < 8; ++q) sum += e.volume[q] * stress(e, q), volume += e.volume[q];
    mean.push_back(sum / volume);
  }
  return mean;
}

std::vector<Vec<3>> HexahedralFem::element_centres() const {
  std::vector<Vec<3>> centres;
  for (const Element& e : elements_) {
    centres.push_back(Vec<3>::Zero());
    for (const Index node : e.node) centres.back() += X_[static_cast<std::size_t>(node)] / 8;
  }
  return centres;
}

}  // namespace taut::bench
