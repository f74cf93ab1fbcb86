#pragma once
/// \file
/// Which pairs of particles count: those with the body between them.

#include <memory>
#include <optional>
#include <span>
#include <taut/geometry/geometry.hpp>
#include <taut/geometry/visibility.hpp>
#include <taut/particles/interfaces.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

/// A pair within the support counts if the body lies between its particles, and they are of one material
/// where those on interfaces have a twin for each.
///
/// On lattices the cells tell: the straight way from site to site has to stay in cells of the body (of the
/// material). Jittered particles stand for their sites. Slits that are narrower than a cell leave no cell
/// out. Clouds without a lattice tell by their boundary: with n the direction of a particle's area vector (of
/// its facets' sum), the way from a to b leaves the body where n_a . X_ab > 0.85 |X_ab|, or n_b . X_ba > 0.85
/// |X_ab|, or both are more than 0.4 |X_ab|. Along the faces of a re-entrant corner n . X is at most 0.82.
/// Where there are no area vectors either, all pairs count.
template <int D>
class PairRule {
 public:
  /// The rule of the particles of a cloud whose pairs are nearer than `reach` [m], images included; null
  /// where all count. With `interfaces` the particles are split into twins.
  static std::shared_ptr<const PairRule> make(const Cloud<D>& cloud, const Particles<D>& particles,
                                              const std::vector<typename MirrorMap<D>::Plane>& planes,
                                              const Interfaces<D>* interfaces, double reach);

  bool counts(Index a, Index b) const;
  /// Whether the body lies between, of whatever materials.
  bool same_body(Index a, Index b) const;

  /// Where a stress stands, for `sees`; `particles` as in `StressSample`.
  struct Sample {
    Index particle = no_particle;
    Site<D> site{};
    std::uint8_t label = 0;
  };
  Sample sample(std::span<const Index> particles, std::uint8_t material) const;
  /// Whether the body lies between a particle and a stress.
  bool sees(Index particle, const Sample& sample) const;

  std::size_t bytes() const {
    return sites_.size() * sizeof(Site<D>) + label_.size() + normals_.size() * sizeof(Vec<D>) +
           (visibility_ ? visibility_->bytes() : 0);
  }

 private:
  bool leaves(Index a, Index b) const;

  const Particles<D>* p_ = nullptr;
  std::optional<Visibility<D>> visibility_;
  bool by_material_ = false;
  std::vector<Site<D>> sites_;       // of each particle and image
  std::vector<std::uint8_t> label_;  // of their cells; empty where all have one
  std::vector<Vec<D>> normals_;      // of particles on the boundary, else zero; without a lattice
};

}  // namespace taut
