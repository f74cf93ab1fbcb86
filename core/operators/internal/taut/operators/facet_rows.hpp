#pragma once
/// \file
/// How displacements of facets follow from those of particles.

#include <span>
#include <taut/geometry/geometry.hpp>
#include <taut/neighbors/pair_list.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

/// For each facet f of a cloud the weights N_fa of a linearly exact extrapolation from its owner o and the
/// owner's neighbours,
///   u(x_f) = u_o + g_o . (x_f - X_o) = sum_a N_fa u_a,
/// with the gradient g_o of the least squares fit to the neighbours, all alike: weights that fall off with
/// the distance make clouds up to a tenth stiffer than this, and no more accurate. Their transpose carries
/// what acts on facets (areas, tractions) to the particles, so that a constant stress balances its tractions
/// on any cloud:
///   B_a = sum_f N_fa A_f,   sum_a B_a = sum_f A_f = 0,   sum_a X_a (x) B_a = sum_f x_f (x) A_f = V I.
template <int D>
class FacetRows {
 public:
  struct Term {
    Index particle;      ///< internal index; of an image its master
    std::uint8_t flips;  ///< bit d: component d of the image has the other sign
    double weight;
  };

  FacetRows() = default;
  /// `facets` have user's ids as owners; `pairs` are of all particles and their images.
  FacetRows(const std::vector<Facet<D>>& facets, const Particles<D>& particles, const PairList& pairs);

  std::span<const Term> row(std::size_t facet) const {
    return {terms_.data() + begin_[facet], terms_.data() + begin_[facet + 1]};
  }
  /// Calls f(particle, vector) with what a vector that acts on the facet (and on its images) makes of the
  /// particles.
  template <class F>
  void spread(std::size_t facet, const Vec<D>& vector, const Particles<D>& p, F&& f) const {
    for (const Term& term : row(facet)) {
      Vec<D> part = term.weight * vector;
      const unsigned planes = p.planes.empty() ? 0u : p.planes[static_cast<std::size_t>(term.particle)];
      for (int d = 0; d < D; ++d) {
        if (term.flips >> d & 1) part[d] = -part[d];
        // What lies on a plane has the image's part as well.
        if (planes >> d & 1) {
          part *= 2;
          part[d] = 0;
        }
      }
      f(term.particle, part);
    }
  }

 private:
  std::vector<std::size_t> begin_{0};
  std::vector<Term> terms_;
};

}  // namespace taut
