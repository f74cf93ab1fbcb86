#pragma once
/// \file
/// The highest frequency of a discrete body.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <taut/base/fields.hpp>
#include <taut/base/simd.hpp>
#include <taut/particles/material_groups.hpp>
#include <vector>

namespace taut {

/// Largest eigenvalue of M^-1 K by power iteration, with K symmetric and positive. `apply(y)` may complete y
/// (D components, zero beyond the n particles at first) and leaves M^-1 K y in `a`; `m` are the masses. Sums
/// are made block by block: the same bits whatever the threads. `stiffest`: which particle moves most in that
/// mode.
template <int D, class Apply>
double largest_eigenvalue(Index n, Index total, const Field& m, Field& a, Apply&& apply,
                          Index* stiffest = nullptr) {
  constexpr int iterations = 30;
  constexpr Index block = 512;  // slices
  Field y(static_cast<std::size_t>(total), D);
  for (Index i = 0; i < n; ++i)
    for (int d = 0; d < D; ++d) {
      // Any start with a part in the highest mode will do; a multiplicative hash gives every frequency its
      // share.
      const auto hash = static_cast<std::uint32_t>(i * D + d + 1) * 2654435761u;
      y.component(d)[i] = static_cast<double>(hash) / 4294967296.0 - 0.5;
    }
  struct Products {
    double yy = 0, ya = 0, aa = 0;  // in the inner product of the masses
  };
  const auto slices = static_cast<Index>(padded(static_cast<std::size_t>(n)) / lanes);
  const Index blocks = (slices + block - 1) / block;
  std::vector<Products> partial(static_cast<std::size_t>(blocks));
  double eigenvalue = 0;
  for (int it = 0; it < iterations; ++it) {
    apply(y);
#pragma omp parallel for schedule(static) if (n > parallel_from)
    for (Index b = 0; b < blocks; ++b) {
      Pack yy = pack(0), ya = pack(0), aa = pack(0);
      for (Index s = b * block; s < std::min((b + 1) * block, slices); ++s) {
        const Index i = s * lanes;
        const Pack mass = load(m.component(0) + i);
        for (int d = 0; d < D; ++d) {
          Pack ad = load(a.component(d) + i), yd = load(y.component(d) + i);
          if (i + lanes > n)
            for (int l = n - i; l < lanes; ++l) ad[l] = yd[l] = 0;
          yy += mass * yd * yd;
          ya += mass * yd * ad;
          aa += mass * ad * ad;
        }
      }
      Products sums;
      for (int l = 0; l < lanes; ++l) {
        sums.yy += yy[l];
        sums.ya += ya[l];
        sums.aa += aa[l];
      }
      partial[static_cast<std::size_t>(b)] = sums;
    }
    Products sums;
    for (const Products& part : partial) {
      sums.yy += part.yy;
      sums.ya += part.ya;
      sums.aa += part.aa;
    }
    if (sums.yy > 0 && sums.ya > 0) eigenvalue = std::max(sums.ya / sums.yy, std::sqrt(sums.aa / sums.yy));
    // Only to keep numbers within range; a power of two rounds nothing, in no system of units.
    const double scale =
        sums.aa > 0 && std::isfinite(sums.aa) ? std::ldexp(1.0, -(std::ilogb(sums.aa) / 2)) : 0;
    for (int d = 0; d < D; ++d) {
      double* to = y.component(d);
      const double* from = a.component(d);
#pragma omp parallel for simd schedule(static) if (n > parallel_from)
      for (Index i = 0; i < n; ++i) to[i] = from[i] * scale;
    }
  }
  if (stiffest) {
    double most = -1;
    for (Index i = 0; i < n; ++i) {
      const double y2 = y.template vec<D>(static_cast<std::size_t>(i)).squaredNorm();
      if (y2 > most) most = y2, *stiffest = i;
    }
  }
  return eigenvalue;
}

}  // namespace taut
