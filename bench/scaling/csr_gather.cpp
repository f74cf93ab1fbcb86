#include <Eigen/LU>
#include <cmath>
#include <scaling/baseline.hpp>
#include <scaling/engine_step.hpp>

namespace taut::bench {
namespace {

class CsrGather final : public Baseline {
 public:
  explicit CsrGather(const BaselineBody& body)
      : mu_(body.material->parameters().mu()), lambda_(body.material->parameters().lambda()) {
    CompressedPairs p = compressed_pairs(body.cloud, body.method);
    id_ = std::move(p.id);
    row_ = std::move(p.row);
    M_ = std::move(p.M);
    pairs_.resize(p.neighbour.size());
    for (std::size_t k = 0; k < pairs_.size(); ++k) pairs_[k] = {p.gradient[k], p.neighbour[k]};
    const std::size_t n = id_.size();
    x_.resize(n);
    v_.assign(n, Vec<3>::Zero());
    a_.resize(n);
    Q_.resize(n);
    V_.resize(n);
    m_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
      const auto id = static_cast<std::size_t>(id_[i]);
      x_[i] = body.cloud.X[id] + start_displacement<3>(body.cloud.X[id]);
      V_[i] = body.cloud.V[id];
      m_[i] = V_[i] * body.material->density();
    }
    update_accelerations(1);
  }

  void step(double dt, int threads) override {
    const std::size_t n = x_.size();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t i = 0; i < n; ++i) {
      v_[i] += dt * a_[i];
      x_[i] += dt * v_[i];
    }
    update_accelerations(threads);
  }

  std::vector<Vec<3>> accelerations() const override {
    std::vector<Vec<3>> a(a_.size());
    for (std::size_t i = 0; i < a.size(); ++i) a[static_cast<std::size_t>(id_[i])] = a_[i];
    return a;
  }
  std::size_t bytes() const override {
    return row_.size() * sizeof(std::int64_t) + pairs_.size() * sizeof(Pair) + id_.size() * sizeof(Index) +
           (x_.size() + v_.size() + a_.size()) * sizeof(Vec<3>) + (M_.size() + Q_.size()) * sizeof(Mat<3>) +
           (V_.size() + m_.size()) * sizeof(double);
  }

 private:
  struct Pair {
    Vec<3> gradient;
    Index neighbour;
  };

  void update_accelerations(int threads) {
    const std::size_t n = x_.size();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t a = 0; a < n; ++a) {
      Mat<3> sum = Mat<3>::Zero();
      for (auto k = static_cast<std::size_t>(row_[a]); k < static_cast<std::size_t>(row_[a + 1]); ++k) {
        const Pair& pair = pairs_[k];
        sum += (x_[static_cast<std::size_t>(pair.neighbour)] - x_[a]) * pair.gradient.transpose();
      }
      const Mat<3> F = sum * M_[a].transpose();
      const Mat<3> inverse_transpose = F.inverse().transpose();
      const Mat<3> P =
          mu_ * (F - inverse_transpose) + lambda_ * std::log(F.determinant()) * inverse_transpose;
      Q_[a] = V_[a] * P * M_[a];
    }
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t a = 0; a < n; ++a) {
      Vec<3> force = Vec<3>::Zero();
      for (auto k = static_cast<std::size_t>(row_[a]); k < static_cast<std::size_t>(row_[a + 1]); ++k) {
        const Pair& pair = pairs_[k];
        force += (Q_[a] + Q_[static_cast<std::size_t>(pair.neighbour)]) * pair.gradient;
      }
      a_[a] = force / m_[a];
    }
  }

  double mu_, lambda_;
  std::vector<Index> id_;
  std::vector<std::int64_t> row_;
  std::vector<Pair> pairs_;
  std::vector<Mat<3>> M_, Q_;
  std::vector<Vec<3>> x_, v_, a_;
  std::vector<double> V_, m_;
};

}  // namespace

std::unique_ptr<Baseline> make_csr_gather(const BaselineBody& body) {
  return std::make_unique<CsrGather>(body);
}

}  // namespace taut::bench
