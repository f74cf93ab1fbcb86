#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <scaling/baseline.hpp>
#include <scaling/engine_step.hpp>
#include <taut/base/parallel.hpp>

namespace taut::bench {
namespace {

using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor, Index>;
// Rows of three values: one product then reads the matrix once for all of them.
using Columns3 = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

class EigenSparse final : public Baseline {
 public:
  explicit EigenSparse(const BaselineBody& body) : material_(body.material) {
    CompressedPairs p = compressed_pairs(body.cloud, body.method);
    id_ = std::move(p.id);
    M_ = std::move(p.M);
    const auto n = static_cast<Eigen::Index>(id_.size());
    for (std::size_t e = 0; e < 3; ++e) {
      N_[e].resize(n, n);
      N_[e].reserve(static_cast<Eigen::Index>(p.neighbour.size()));
      std::vector<std::pair<Index, double>> row;
      for (Eigen::Index a = 0; a < n; ++a) {
        row.clear();
        for (auto k = static_cast<std::size_t>(p.row[static_cast<std::size_t>(a)]);
             k < static_cast<std::size_t>(p.row[static_cast<std::size_t>(a) + 1]); ++k)
          row.emplace_back(p.neighbour[k], p.gradient[k][static_cast<Eigen::Index>(e)]);
        std::sort(row.begin(), row.end());
        N_[e].startVec(a);
        for (const auto& [b, value] : row) N_[e].insertBack(a, b) = value;
      }
      N_[e].finalize();
      row_sum_[e] = N_[e] * Eigen::VectorXd::Ones(n);
      H_[e] = Q_[e] = Columns3::Zero(n, 3);
    }
    x_ = v_ = a_ = Columns3::Zero(n, 3);
    V_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto id = static_cast<std::size_t>(id_[static_cast<std::size_t>(i)]);
      x_.row(i) = body.cloud.X[id] + start_displacement<3>(body.cloud.X[id]);
      V_[i] = body.cloud.V[id];
    }
    update_accelerations();
  }

  void step(double dt, int threads) override {
    const int before = Eigen::nbThreads();
    Eigen::setNbThreads(threads);
    threads_ = threads;
    const Eigen::Index n = x_.rows();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (Eigen::Index i = 0; i < n; ++i) {
      v_.row(i) += dt * a_.row(i);
      x_.row(i) += dt * v_.row(i);
    }
    update_accelerations();
    Eigen::setNbThreads(before);
  }

  std::vector<Vec<3>> accelerations() const override {
    std::vector<Vec<3>> a(id_.size());
    for (std::size_t i = 0; i < a.size(); ++i)
      a[static_cast<std::size_t>(id_[i])] = a_.row(static_cast<Eigen::Index>(i));
    return a;
  }
  std::size_t bytes() const override {
    std::size_t bytes = id_.size() * sizeof(Index) + M_.size() * sizeof(Mat<3>);
    for (const Sparse& N : N_)
      bytes += static_cast<std::size_t>(N.nonZeros()) * (sizeof(double) + sizeof(Index)) +
               static_cast<std::size_t>(N.rows() + 1) * sizeof(Index);
    // Three fields of motion, three of H and of Q, row sums and volumes.
    return bytes + static_cast<std::size_t>(x_.size()) * sizeof(double) * (3 + 3 + 3) +
           static_cast<std::size_t>(x_.rows()) * sizeof(double) * 4;
  }

 private:
  void update_accelerations() {
    for (std::size_t e = 0; e < 3; ++e) H_[e].noalias() = N_[e] * x_;  // H_e(a, d) = sum_b G_ab,e x_b,d
    stress();
    a_.noalias() = N_[0] * Q_[0];
    a_.noalias() += N_[1] * Q_[1];
    a_.noalias() += N_[2] * Q_[2];
    const double density = material_->density();
    const Eigen::Index n = a_.rows();
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (Eigen::Index i = 0; i < n; ++i) {
      for (std::size_t e = 0; e < 3; ++e) a_.row(i) += row_sum_[e][i] * Q_[e].row(i);
      a_.row(i) /= V_[i] * density;
    }
  }

  // Q_e(a, d) from H, a block of particles at a time.
  void stress() {
    constexpr int block = 64;
    const Eigen::Index n = x_.rows();
    ParallelError error;
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (Eigen::Index first = 0; first < n; first += block)
      error.guard([&] {
        alignas(64) double F[9 * block], P[9 * block];
        for (int l = 0; l < block; ++l) {
          // The last block is filled up with its last particle.
          const Eigen::Index i = std::min(first + l, n - 1);
          Mat<3> sum;
          for (std::size_t e = 0; e < 3; ++e)
            sum.col(static_cast<Eigen::Index>(e)) = H_[e].row(i) - row_sum_[e][i] * x_.row(i);
          const Mat<3> Fi = sum * M_[static_cast<std::size_t>(i)].transpose();
          for (int c = 0; c < 9; ++c) F[c * block + l] = Fi(c / 3, c % 3);
        }
        material_->stress({block, block, F, P, nullptr});
        for (int l = 0; l < std::min<Eigen::Index>(block, n - first); ++l) {
          const Eigen::Index i = first + l;
          Mat<3> Pi;
          for (int c = 0; c < 9; ++c) Pi(c / 3, c % 3) = P[c * block + l];
          const Mat<3> Q = V_[i] * Pi * M_[static_cast<std::size_t>(i)];
          for (std::size_t e = 0; e < 3; ++e) Q_[e].row(i) = Q.col(static_cast<Eigen::Index>(e));
        }
      });
    error.rethrow();
  }

  std::shared_ptr<const Hyperelastic<3>> material_;
  std::vector<Index> id_;
  std::array<Sparse, 3> N_;
  std::array<Eigen::VectorXd, 3> row_sum_;
  std::array<Columns3, 3> H_, Q_;
  std::vector<Mat<3>> M_;
  Columns3 x_, v_, a_;
  Eigen::VectorXd V_;
  int threads_ = 1;
};

}  // namespace

std::unique_ptr<Baseline> make_eigen_sparse(const BaselineBody& body) {
  return std::make_unique<EigenSparse>(body);
}

}  // namespace taut::bench
