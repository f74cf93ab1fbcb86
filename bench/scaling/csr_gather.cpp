#include <Eigen/LU>
#include <cmath>
#include <scaling/baseline.hpp>
#include <scaling/engine_step.hpp>

namespace taut::bench {
namespace {

/// A total Lagrangian step as most codes write it: an array of particles, each a struct of small Eigen
/// matrices, and for each its neighbours with kernel gradients in compressed rows.
class CsrGather final : public Baseline {
 public:
  explicit CsrGather(const BaselineBody& body)
      : mu_(body.material->parameters().mu()), lambda_(body.material->parameters().lambda()) {
    CompressedPairs p = compressed_pairs(body.cloud, body.method);
    row_ = std::move(p.row);
    pairs_.resize(p.neighbour.size());
    for (std::size_t k = 0; k < pairs_.size(); ++k) pairs_[k] = {p.gradient[k], p.neighbour[k]};
    particles_.resize(p.id.size());
    for (std::size_t i = 0; i < particles_.size(); ++i) {
      const auto id = static_cast<std::size_t>(p.id[i]);
      Particle& particle = particles_[i];
      particle.id = p.id[i];
      particle.X = body.cloud.X[id];
      particle.x = particle.X + start_displacement<3>(particle.X);
      particle.M = p.M[i];
      particle.V = body.cloud.V[id];
      particle.m = particle.V * body.material->density();
    }
    update_accelerations(1);
  }

  void step(double dt, int threads) override {
    const std::size_t n = particles_.size();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t i = 0; i < n; ++i) {
      particles_[i].v += dt * particles_[i].a;
      particles_[i].x += dt * particles_[i].v;
    }
    update_accelerations(threads);
  }

  std::vector<Vec<3>> accelerations() const override {
    std::vector<Vec<3>> a(particles_.size());
    for (const Particle& particle : particles_) a[static_cast<std::size_t>(particle.id)] = particle.a;
    return a;
  }
  std::size_t bytes() const override {
    return row_.size() * sizeof(std::int64_t) + pairs_.size() * sizeof(Pair) +
           particles_.size() * sizeof(Particle);
  }

 private:
  struct Particle {
    Vec<3> X, x, v = Vec<3>::Zero(), a = Vec<3>::Zero();
    Mat<3> F, P, M, Q;  // Q = V P M
    double V, m;
    Index id;
  };
  struct Pair {
    Vec<3> gradient;
    Index neighbour;
  };

  void update_accelerations(int threads) {
    const std::size_t n = particles_.size();
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t i = 0; i < n; ++i) {
      Particle& a = particles_[i];
      Mat<3> sum = Mat<3>::Zero();
      for (auto k = static_cast<std::size_t>(row_[i]); k < static_cast<std::size_t>(row_[i + 1]); ++k) {
        const Particle& b = particles_[static_cast<std::size_t>(pairs_[k].neighbour)];
        sum += (b.x - a.x) * pairs_[k].gradient.transpose();
      }
      a.F = sum * a.M.transpose();
      const Mat<3> inverse_transpose = a.F.inverse().transpose();
      a.P = mu_ * (a.F - inverse_transpose) + lambda_ * std::log(a.F.determinant()) * inverse_transpose;
      a.Q = a.V * a.P * a.M;
    }
#pragma omp parallel for schedule(static) num_threads(threads)
    for (std::size_t i = 0; i < n; ++i) {
      Particle& a = particles_[i];
      Vec<3> force = Vec<3>::Zero();
      for (auto k = static_cast<std::size_t>(row_[i]); k < static_cast<std::size_t>(row_[i + 1]); ++k)
        force += (a.Q + particles_[static_cast<std::size_t>(pairs_[k].neighbour)].Q) * pairs_[k].gradient;
      a.a = force / a.m;
    }
  }

  double mu_, lambda_;
  std::vector<std::int64_t> row_;
  std::vector<Pair> pairs_;
  std::vector<Particle> particles_;
};

}  // namespace

std::unique_ptr<Baseline> make_csr_gather(const BaselineBody& body) {
  return std::make_unique<CsrGather>(body);
}

}  // namespace taut::bench
