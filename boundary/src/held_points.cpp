#include <fmt/format.h>

#include <Eigen/SparseCholesky>
#include <taut/base/error.hpp>
#include <taut/boundary/held_points.hpp>
#include <utility>

namespace taut {

template <int D>
struct HeldPoints<D>::System {
  Eigen::SparseMatrix<double> from_points;                     // M^-1 C^T, a column a point
  std::vector<Index> particles;                                // of its rows
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factors;  // of C M^-1 C^T
  Eigen::VectorXd per_pivot;                                   // 1 / D of these
  Eigen::VectorXd ordered, force, change;                      // of the last projection
};

template <int D>
HeldPoints<D>::HeldPoints() = default;
template <int D>
HeldPoints<D>::~HeldPoints() = default;
template <int D>
HeldPoints<D>::HeldPoints(HeldPoints&&) noexcept = default;
template <int D>
HeldPoints<D>& HeldPoints<D>::operator=(HeldPoints&&) noexcept = default;

template <int D>
void HeldPoints<D>::add(std::vector<BoundPoint<D>> points, PrescribedMotion<D> motion) {
  motions_.push_back(std::move(motion));
  for (BoundPoint<D>& point : points) {
    const auto [at, is_new] = place_.try_emplace(point.number, points_.size());
    const std::size_t k = at->second;
    if (is_new) {
      points_.emplace_back();
      set_.emplace_back();
    }
    points_[k] = std::move(point);
    set_[k] = motions_.size() - 1;
  }
}

template <int D>
void HeldPoints<D>::factor(const Field& mass, const std::vector<char>& fixed) {
  system_ = std::make_unique<System>();
  row_point_.clear();
  std::vector<Index> column(fixed.size(), no_particle);
  std::vector<Eigen::Triplet<double>> entries;  // of C
  for (std::size_t k = 0; k < points_.size(); ++k) {
    bool free = false;
    for (const auto& term : points_[k].terms) {
      const auto i = static_cast<std::size_t>(term.particle);
      if (fixed[i] || term.weight == 0) continue;
      free = true;
      if (column[i] == no_particle) {
        column[i] = static_cast<Index>(system_->particles.size());
        system_->particles.push_back(term.particle);
      }
      entries.emplace_back(static_cast<int>(row_point_.size()), column[i], term.weight);
    }
    if (free) row_point_.push_back(k);
  }
  now_.resize(motions_.size());
  defect_.resize(row_point_.size());
  if (row_point_.empty()) return;
  const auto points = static_cast<Eigen::Index>(row_point_.size());
  const auto particles = static_cast<Eigen::Index>(system_->particles.size());
  Eigen::SparseMatrix<double> C(points, particles);
  C.setFromTriplets(entries.begin(), entries.end());
  // No roots: results are the same bits in units that differ by powers of two.
  Eigen::VectorXd per_mass(particles);
  for (Eigen::Index c = 0; c < particles; ++c)
    per_mass[c] = 1 / mass.component(0)[system_->particles[static_cast<std::size_t>(c)]];
  system_->from_points = per_mass.asDiagonal() * Eigen::SparseMatrix<double>(C.transpose());
  const Eigen::SparseMatrix<double> normal = C * system_->from_points;
  system_->factors.compute(normal);
  constexpr double redundant = 1e-10;  // pivots of independent rows are of the order of the diagonal
  if (system_->factors.info() != Eigen::Success ||
      !(system_->factors.vectorD().minCoeff() > redundant * normal.diagonal().maxCoeff()))
    throw InputError(fmt::format(
        "the {} points held on the boundary do not move independently: where walls meet, or in a body one "
        "particle thick, they hold the same particles twice. Hold fewer of them, or refine dx there",
        points));
  system_->per_pivot = system_->factors.vectorD().cwiseInverse();
  system_->ordered.resize(points);
  system_->force.resize(points);
  system_->change.resize(particles);
}

// As Eigen solves, but for the memory that it takes to reorder.
template <int D>
void HeldPoints<D>::correct(double* values) const {
  System& s = *system_;
  const auto& place = s.factors.permutationP().indices();
  for (Eigen::Index r = 0; r < place.size(); ++r) s.ordered[place[r]] = defect_[static_cast<std::size_t>(r)];
  s.factors.matrixL().solveInPlace(s.ordered);
  s.ordered.array() *= s.per_pivot.array();
  s.factors.matrixU().solveInPlace(s.ordered);
  for (Eigen::Index r = 0; r < place.size(); ++r) s.force[r] = s.ordered[place[r]];
  s.change.noalias() = s.from_points * s.force;
  for (std::size_t c = 0; c < s.particles.size(); ++c)
    values[s.particles[c]] += s.change[static_cast<Eigen::Index>(c)];
}

template class HeldPoints<1>;
template class HeldPoints<2>;
template class HeldPoints<3>;

}  // namespace taut
