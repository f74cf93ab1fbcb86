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

/// Chunks of consecutive particles with the material they are of, or `mixed`.
class MaterialGroups {
 public:
  static constexpr int mixed = -1;

  template <int D>
  explicit MaterialGroups(const Particles<D>& p)
      : n_(p.n), material_(p.material), only_(static_cast<std::size_t>(chunks()), mixed) {
    for (Index c = 0; c < chunks(); ++c) {
      const auto begin = material_.begin() + first(c), end = material_.begin() + std::min(first(c + 1), n_);
      if (std::all_of(begin, end, [&](std::uint8_t m) { return m == *begin; }))
        only_[static_cast<std::size_t>(c)] = *begin;
    }
  }

  Index slices() const { return static_cast<Index>(padded(static_cast<std::size_t>(n_)) / lanes); }
  Index chunks() const { return (slices() + chunk_slices - 1) / chunk_slices; }
  Index first(Index c) const { return c * chunk_particles; }
  Index first_slice(Index c) const { return c * chunk_slices; }
  Index last_slice(Index c) const { return std::min(first_slice(c + 1), slices()); }

  /// Calls `evaluate(m, out)` so that component k of particle i of the chunk ends up in out[k *
  /// chunk_particles + i] from its own material m. On a border of materials each is asked for the whole
  /// chunk.
  template <int Components, class Evaluate>
  void call(Index c, double* out, Evaluate&& evaluate) const {
    const int only = only_[static_cast<std::size_t>(c)];
    if (only != mixed) {
      evaluate(static_cast<std::size_t>(only), out);
      return;
    }
    alignas(64) double each[Components * chunk_particles], result[Components * chunk_particles] = {};
    const std::size_t materials = 1u + *std::max_element(material_.begin(), material_.end());
    for (std::size_t m = 0; m < materials; ++m) {
      evaluate(m, each);
      for (Index i = 0; i < (last_slice(c) - first_slice(c)) * lanes; ++i) {
        if (material_[static_cast<std::size_t>(std::min(first(c) + i, n_ - 1))] != m) continue;
        for (int k = 0; k < Components; ++k) result[k * chunk_particles + i] = each[k * chunk_particles + i];
      }
    }
    std::copy(std::begin(result), std::end(result), out);
  }

 private:
  Index n_;
  std::vector<std::uint8_t> material_;
  std::vector<std::int16_t> only_;
};

}  // namespace taut
