#pragma once
/// \file
/// The few types that every part of taut shares.

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace taut {

/// Index of a particle. 32 bits: two thousand million particles are more than one machine holds.
using Index = std::int32_t;
inline constexpr Index no_particle = -1;

/// Particles that one slice of a pair list, one pack of doubles and one step of the padding hold.
inline constexpr int lanes = 8;

/// A matrix whose layout depends on no compiler flag. By default Eigen aligns to what the instruction set
/// likes: a library built with -march=native and a program built without it would disagree on addresses.
/// Converts from and to Eigen's default types (which SelfAdjointEigenSolver::compute of Eigen 3.4 needs).
template <int Rows, int Columns = Rows>
using Fixed =
    Eigen::Matrix<double, Rows, Columns,
                  Eigen::DontAlign | (Rows == 1 && Columns != 1 ? Eigen::RowMajor : Eigen::ColMajor)>;

template <int D>
using Vec = Fixed<D, 1>;
template <int D>
using Mat = Fixed<D>;

static_assert(alignof(Vec<1>) == alignof(double) && sizeof(Vec<1>) == 1 * sizeof(double));
static_assert(alignof(Vec<2>) == alignof(double) && sizeof(Vec<2>) == 2 * sizeof(double));
static_assert(alignof(Vec<3>) == alignof(double) && sizeof(Vec<3>) == 3 * sizeof(double));
static_assert(alignof(Mat<1>) == alignof(double) && sizeof(Mat<1>) == 1 * sizeof(double));
static_assert(alignof(Mat<2>) == alignof(double) && sizeof(Mat<2>) == 4 * sizeof(double));
static_assert(alignof(Mat<3>) == alignof(double) && sizeof(Mat<3>) == 9 * sizeof(double));

/// `n` rounded up to whole packs.
constexpr std::size_t padded(std::size_t n) { return (n + lanes - 1) / lanes * lanes; }

}  // namespace taut
