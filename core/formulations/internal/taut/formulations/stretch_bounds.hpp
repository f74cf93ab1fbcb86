#pragma once
/// \file
/// Bounds of the principal stretches over many deformation gradients, without a square root or branch a
/// particle.

#include <algorithm>
#include <cmath>
#include <limits>
#include <taut/base/simd.hpp>

namespace taut {

/// Intervals that hold every principal stretch, and every J.
struct StretchBounds {
  double min = 1, max = 1;
  double J_min = 1, J_max = 1;
};

/// Gathers the extremes of tr C, of the variance of its eigenvalues and of J, from which the bounds follow
/// (Wolkowicz & Styan 1980: mean ± sqrt(D - 1) standard deviations).
template <int D>
class StretchExtremes {
 public:
  /// Adds eight gradients (row-major) and returns their determinants.
  TAUT_INLINE Pack add(const Pack (&F)[D * D]) {
    Pack J, mean, variance;
    if constexpr (D == 1) {
      J = F[0];
      mean = F[0] * F[0];
      variance = pack(0);
    } else {
      Pack C[D][D];
      for (int i = 0; i < D; ++i)
        for (int j = i; j < D; ++j) {
          C[i][j] = F[i] * F[j];
          for (int k = 1; k < D; ++k) C[i][j] += F[k * D + i] * F[k * D + j];
        }
      if constexpr (D == 2) {
        J = F[0] * F[3] - F[1] * F[2];
        mean = 0.5 * (C[0][0] + C[1][1]);
        const Pack half = 0.5 * (C[0][0] - C[1][1]);
        variance = half * half + C[0][1] * C[0][1];
      } else {
        J = F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) +
            F[2] * (F[3] * F[7] - F[4] * F[6]);
        mean = (C[0][0] + C[1][1] + C[2][2]) * (1.0 / 3);
        const Pack a = C[0][0] - mean, b = C[1][1] - mean, c = C[2][2] - mean;
        variance = (a * a + b * b + c * c + 2 * (C[0][1] * C[0][1] + C[0][2] * C[0][2] + C[1][2] * C[1][2])) *
                   (1.0 / 3);
      }
    }
    mean_max_ = mean > mean_max_ ? mean : mean_max_;
    mean_min_ = mean < mean_min_ ? mean : mean_min_;
    variance_ = variance > variance_ ? variance : variance_;
    J_min_ = J < J_min_ ? J : J_min_;
    J_max_ = J > J_max_ ? J : J_max_;
    return J;
  }

  void merge(const StretchExtremes& o) {
    mean_max_ = o.mean_max_ > mean_max_ ? o.mean_max_ : mean_max_;
    mean_min_ = o.mean_min_ < mean_min_ ? o.mean_min_ : mean_min_;
    variance_ = o.variance_ > variance_ ? o.variance_ : variance_;
    J_min_ = o.J_min_ < J_min_ ? o.J_min_ : J_min_;
    J_max_ = o.J_max_ > J_max_ ? o.J_max_ : J_max_;
  }

  StretchBounds bounds() const {
    double mean_max = 0, mean_min = mean_min_[0], variance = 0, J = J_min_[0], J_max = J_max_[0];
    for (int l = 0; l < lanes; ++l) {
      mean_max = std::max(mean_max, mean_max_[l]);
      mean_min = std::min(mean_min, mean_min_[l]);
      variance = std::max(variance, variance_[l]);
      J = std::min(J, J_min_[l]);
      J_max = std::max(J_max, J_max_[l]);
    }
    const double spread = std::sqrt((D - 1) * variance);
    StretchBounds b;
    b.max = std::sqrt(mean_max + spread);
    const double by_mean = std::sqrt(std::max(0.0, mean_min - spread));
    const double by_volume = J > 0 ? J / std::pow(b.max, D - 1) : 0;
    b.min = std::max({by_mean, by_volume, 1e-3});
    b.J_min = std::max(J, 0.0);
    b.J_max = std::max(J_max, b.J_min);
    return b;
  }

 private:
  Pack mean_max_ = pack(0), mean_min_ = pack(1e300), variance_ = pack(0), J_min_ = pack(1e300),
       J_max_ = pack(0);
};

}  // namespace taut
