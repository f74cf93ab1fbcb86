#pragma once
/// \file
/// Which material each chunk of particles calls.

#include <algorithm>
#include <cstdint>
#include <taut/base/types.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

/// Particles that one material call sees.
inline constexpr int chunk_slices = 8;
inline constexpr int chunk_particles = chunk_slices * lanes;

/// Fewer particles than this are not worth waking the other threads for.
inline constexpr Index parallel_from = 4096;

/// Chunks of consecutive particles with the materials that they hold.
class MaterialGroups {
 public:
  template <int D>
  explicit MaterialGroups(const Particles<D>& p) : n_(p.n), material_(p.material) {
    // Lanes behind the last particle do as it does.
    if (n_ > 0) material_.resize(static_cast<std::size_t>(slices()) * lanes, material_.back());
    begin_.push_back(0);
    for (Index c = 0; c < chunks(); ++c) {
      const std::size_t before = held_.size();
      for (Index i = first(c); i < last_slice(c) * lanes; ++i) {
        const std::uint8_t m = material_[static_cast<std::size_t>(i)];
        if (std::find(held_.begin() + static_cast<std::ptrdiff_t>(before), held_.end(), m) == held_.end())
          held_.push_back(m);
      }
      begin_.push_back(held_.size());
    }
  }

  Index slices() const { return static_cast<Index>(padded(static_cast<std::size_t>(n_)) / lanes); }
  Index chunks() const { return (slices() + chunk_slices - 1) / chunk_slices; }
  Index first(Index c) const { return c * chunk_particles; }
  Index first_slice(Index c) const { return c * chunk_slices; }
  Index last_slice(Index c) const { return std::min(first_slice(c + 1), slices()); }

  /// Calls `evaluate(m, out)` so that component k of particle i of the chunk ends up in out[k *
  /// chunk_particles + i] from its own material m. On a border of materials each that the chunk holds is
  /// asked for all of it.
  template <int Components, class Evaluate>
  void call(Index c, double* out, Evaluate&& evaluate) const {
    const std::uint8_t* m = held_.data() + begin_[static_cast<std::size_t>(c)];
    const std::uint8_t* end = held_.data() + begin_[static_cast<std::size_t>(c) + 1];
    evaluate(static_cast<std::size_t>(*m), out);
    if (++m == end) return;
    alignas(64) double each[Components * chunk_particles];
    const std::uint8_t* own = material_.data() + first(c);
    const Index count = (last_slice(c) - first_slice(c)) * lanes;
    for (; m != end; ++m) {
      evaluate(static_cast<std::size_t>(*m), each);
      for (int k = 0; k < Components; ++k)
        for (Index i = k * chunk_particles; i < k * chunk_particles + count; ++i)
          out[i] = own[i - k * chunk_particles] == *m ? each[i] : out[i];
    }
  }

 private:
  Index n_;
  std::vector<std::uint8_t> material_;  // of each particle, to the end of the last slice
  std::vector<std::size_t> begin_;      // of each chunk in `held_`, and the end
  std::vector<std::uint8_t> held_;
};

}  // namespace taut
