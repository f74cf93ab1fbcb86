#pragma once
/// \file
/// Tensors of packs: eight particles' deformation gradients at once.

#include <taut/base/simd_math.hpp>
#include <taut/materials/material.hpp>

namespace taut {

/// A D×D tensor in each of the lanes, row-major.
template <int D>
struct TensorPack {
  Pack c[D * D];
  TAUT_INLINE Pack& operator()(int i, int j) { return c[i * D + j]; }
  TAUT_INLINE const Pack& operator()(int i, int j) const { return c[i * D + j]; }
};

template <int D>
TAUT_INLINE TensorPack<D> load_tensor(const double* at, std::size_t stride) {
  TensorPack<D> t;
  for (int i = 0; i < D * D; ++i) t.c[i] = load(at + i * stride);
  return t;
}

template <int D>
TAUT_INLINE void store_tensor(double* at, std::size_t stride, const TensorPack<D>& t) {
  for (int i = 0; i < D * D; ++i) store(at + i * stride, t.c[i]);
}

/// Cofactors: F^-T det F.
template <int D>
TAUT_INLINE TensorPack<D> cofactor(const TensorPack<D>& F) {
  if constexpr (D == 1) {
    return {{pack(1)}};
  } else if constexpr (D == 2) {
    return {{F.c[3], -F.c[2], -F.c[1], F.c[0]}};
  } else {
    return {{F.c[4] * F.c[8] - F.c[5] * F.c[7], F.c[5] * F.c[6] - F.c[3] * F.c[8],
             F.c[3] * F.c[7] - F.c[4] * F.c[6], F.c[2] * F.c[7] - F.c[1] * F.c[8],
             F.c[0] * F.c[8] - F.c[2] * F.c[6], F.c[1] * F.c[6] - F.c[0] * F.c[7],
             F.c[1] * F.c[5] - F.c[2] * F.c[4], F.c[2] * F.c[3] - F.c[0] * F.c[5],
             F.c[0] * F.c[4] - F.c[1] * F.c[3]}};
  }
}

/// det F, given its cofactors.
template <int D>
TAUT_INLINE Pack determinant(const TensorPack<D>& F, const TensorPack<D>& cof) {
  Pack J = F.c[0] * cof.c[0];
  for (int j = 1; j < D; ++j) J += F.c[j] * cof.c[j];
  return J;
}

/// H = F - I, exact for entries within a factor of two of those of I.
template <int D>
TAUT_INLINE TensorPack<D> displacement_gradient(TensorPack<D> F) {
  for (int i = 0; i < D; ++i) F(i, i) = F(i, i) - 1.0;
  return F;
}

/// The same of eight particles of a block, from p on, whose deformation gradients are F.
template <int D>
TAUT_INLINE TensorPack<D> displacement_gradient(const StressBlock<D>& block, int p, const TensorPack<D>& F) {
  if (!block.H_diagonal) return displacement_gradient(F);
  TensorPack<D> H = F;
  for (int i = 0; i < D; ++i)
    H(i, i) = load(block.H_diagonal + static_cast<std::size_t>(i) * block.stride + p);
  return H;
}

template <int D>
TAUT_INLINE Pack trace(const TensorPack<D>& A) {
  Pack t = A(0, 0);
  for (int i = 1; i < D; ++i) t += A(i, i);
  return t;
}

/// A : A.
template <int D>
TAUT_INLINE Pack norm_squared(const TensorPack<D>& A) {
  Pack t = A.c[0] * A.c[0];
  for (int i = 1; i < D * D; ++i) t += A.c[i] * A.c[i];
  return t;
}

/// det(I + H) - 1, accurate to round-off of its own size for small H.
template <int D>
TAUT_INLINE Pack volume_change(const TensorPack<D>& H) {
  if constexpr (D == 1) {
    return H.c[0];
  } else {
    const TensorPack<D> cof = cofactor(H);
    const Pack det = determinant(H, cof);
    return D == 2 ? trace(H) + det : trace(H) + trace(cof) + det;
  }
}

/// Green strain (F^T F - I) / 2 = sym(H) + H^T H / 2, which does not cancel for small H.
template <int D>
TAUT_INLINE TensorPack<D> green_strain(const TensorPack<D>& H) {
  TensorPack<D> E;
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j) {
      Pack e = H(i, j) + H(j, i);
      for (int k = 0; k < D; ++k) e += H(k, i) * H(k, j);
      E(i, j) = E(j, i) = 0.5 * e;
    }
  return E;
}

/// lambda tr(E) I + 2 mu E.
template <int D>
TAUT_INLINE TensorPack<D> hooke(const TensorPack<D>& E, double lambda, double mu) {
  const Pack pressure = lambda * trace(E);
  TensorPack<D> S;
  for (int i = 0; i < D * D; ++i) S.c[i] = 2 * mu * E.c[i];
  for (int i = 0; i < D; ++i) S(i, i) += pressure;
  return S;
}

template <int D>
TAUT_INLINE Pack hooke_energy(const TensorPack<D>& E, double lambda, double mu) {
  const Pack tr = trace(E);
  return 0.5 * lambda * tr * tr + mu * norm_squared(E);
}

template <int D>
TAUT_INLINE TensorPack<D> product(const TensorPack<D>& A, const TensorPack<D>& B) {
  TensorPack<D> C;
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      Pack c = A(i, 0) * B(0, j);
      for (int k = 1; k < D; ++k) c += A(i, k) * B(k, j);
      C(i, j) = c;
    }
  return C;
}

}  // namespace taut
