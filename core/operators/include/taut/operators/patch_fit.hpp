#pragma once
/// \file
/// Fields made smooth: polynomials fitted to scattered samples.

#include <functional>
#include <span>
#include <taut/base/types.hpp>
#include <vector>

namespace taut {

/// Points, each of a group: fits never mix groups.
template <int D>
struct PatchPoints {
  std::vector<Vec<D>> X;     ///< [m]
  std::vector<Index> group;  ///< of each point
};

/// Moving least squares (Lancaster & Salkauskas 1981): at each target the value of the quadratic that fits
/// the samples around it best, weighted by distance (Wendland's C2 kernel). Quadratic fields are reproduced
/// exactly, up to faces, edges and corners; with targets there, samples at superconvergent points and fields
/// of stress this is the patch recovery of Zienkiewicz & Zhu (Int. J. Numer. Meth. Engng 33, 1992). What the
/// samples of a patch do not determine is left out: of a sheet two samples thick, the part that is quadratic
/// across it. Linear fields then remain exact, and of samples that determine even less, constant ones. The
/// fits are made once; each evaluation is a sum over the patches.
template <int D>
class PatchFit {
 public:
  /// Samples within `radius` [m] of a target are its patch, those of its group that it `sees` (empty: all).
  /// They are the targets themselves (the same points and groups), or none of them coincides with any; with
  /// `coincident` points of different groups may. \throws InputError for a radius that is not positive,
  /// numbers of points and groups that differ, a target without a sample of its group in its patch (its
  /// number and position), and as `find_pairs`.
  PatchFit(const PatchPoints<D>& targets, const PatchPoints<D>& samples, double radius,
           const std::function<bool(Index target, Index sample)>& sees = {}, bool coincident = false);

  /// Values at the targets from those at the samples, one for each. \throws InputError for another number.
  std::vector<Mat<D>> operator()(std::span<const Mat<D>> samples) const;

  std::size_t bytes() const;

 private:
  static constexpr int terms = 1 + D + D * (D + 1) / 2;
  using Terms = Fixed<terms, 1>;

  Terms monomials(const Vec<D>& distance) const;
  double weight(const Vec<D>& distance) const;
  Terms functional(Index target) const;
  std::span<const Index> patch(Index target) const {
    const auto t = static_cast<std::size_t>(target);
    return {patch_.data() + begin_[t], patch_.data() + begin_[t + 1]};
  }

  double radius_;
  std::vector<Vec<D>> X_, samples_;
  std::vector<std::size_t> begin_;  // of each target's patch
  std::vector<Index> patch_;        // samples
  std::vector<Terms>
      functional_;  // a sample's share is its weight times the product of these and its monomials
};

}  // namespace taut
