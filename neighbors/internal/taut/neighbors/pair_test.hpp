#pragma once
// Which particles of the slices near a group pair with those of one of its slices.

#include <taut/neighbors/neighbourhood.hpp>
#include <vector>

namespace taut::detail::inline TAUT_SIMD_NAMESPACE {

// Tests in single precision, and in double where that cannot tell: the pairs are those of the definition, to
// the last bit.
template <int D>
class PairTest {
 public:
  PairTest(const PointView<D>& points, const Radii& radii) : points_(points), radii_(radii) {}

  // Returns the lanes of the slice, one of the neighbourhood's group, that lie on another particle.
  unsigned run(const Slice<D>& slice, const Neighbourhood<D>& near, const SliceGroup<D>& group);

  // The slices that were tested, ascending, and for each of their particles a byte: lanes that pair with it.
  std::size_t count() const { return count_; }
  const Index* slices() const { return slices_.data(); }
  const std::uint64_t* matches() const { return matches_.data(); }

 private:
  void pick(const Neighbourhood<D>& near, std::size_t own);
  template <bool graded>
  bool test(const Neighbourhood<D>& near, std::size_t own);
  void set_matches();
  std::uint64_t exact(const Slice<D>& slice, Index other, double& least) const;
  unsigned coincident_lanes(const Slice<D>& slice, const Neighbourhood<D>& near) const;

  PointView<D> points_;
  Radii radii_;
  std::size_t count_ = 0;
  std::vector<Index> places_, slices_;  // of what is tested: in the neighbourhood, and of all
  std::vector<std::uint64_t> matches_;
  std::vector<std::uint64_t> first_lanes_, last_lanes_;  // of two slices, a bit a particle for each lane
  std::vector<std::size_t> doubtful_;                    // those whose pairs are too near to a radius
};

}  // namespace taut::detail::inline TAUT_SIMD_NAMESPACE
