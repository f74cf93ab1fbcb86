#include <algorithm>
#include <cmath>
#include <taut/particles/pair_rule.hpp>

namespace taut {

namespace {

template <int D>
std::vector<std::uint8_t> labels_of(const Occupancy<D>& lattice, const Interfaces<D>* interfaces) {
  std::vector<std::uint8_t> label(lattice.cells(), Visibility<D>::nothing);
  if (interfaces) {
    for (std::size_t q = 0; q < interfaces->cells().size(); ++q)
      label[static_cast<std::size_t>(interfaces->cells()[q])] =
          static_cast<std::uint8_t>(1 + interfaces->cell_material()[q]);
  } else {
    for (std::size_t k = 0; k < label.size(); ++k) label[k] = lattice.filled(k) > 0;
  }
  return label;
}

// Coordinates on a lattice of places given in space, relative to a particle that jitter has not moved.
template <int D>
struct LatticeFrame {
  Vec<D> X, spacing;
  Site<D> site;

  Index at(int axis, double x) const {
    return static_cast<Index>(std::lround(2 * (x - X[axis]) / spacing[axis])) +
           site[static_cast<std::size_t>(axis)];
  }
};

}  // namespace

template <int D>
std::shared_ptr<const PairRule<D>> PairRule<D>::make(const Cloud<D>& cloud, const Particles<D>& p,
                                                     const std::vector<typename MirrorMap<D>::Plane>& planes,
                                                     const Interfaces<D>* interfaces, double reach) {
  const Occupancy<D>* lattice = cloud.body.get();
  if (lattice && lattice->gapless && !interfaces) return nullptr;
  lattice = lattice_of(cloud);
  auto rule = std::make_shared<PairRule>();
  rule->p_ = &p;
  const auto n = static_cast<std::size_t>(p.n), total = static_cast<std::size_t>(p.total);
  if (!lattice) {
    if (cloud.B.empty() && cloud.facets.empty()) return nullptr;
    std::vector<Vec<D>> area = cloud.B;
    if (area.empty()) {
      area.assign(cloud.size(), Vec<D>::Zero());
      for (const Facet<D>& f : cloud.facets) area[static_cast<std::size_t>(f.owner)] += f.area;
    }
    rule->normals_.assign(total, Vec<D>::Zero());
    for (std::size_t i = 0; i < n; ++i) {
      Vec<D> A = area[static_cast<std::size_t>(p.id[i])];
      for (int d = 0; d < D; ++d)
        if (!p.planes.empty() && (p.planes[i] >> d & 1)) A[d] = 0;
      if (A.norm() > 1e-9 * std::pow(cloud.dx, D - 1)) rule->normals_[i] = A.normalized();
    }
    for (Index k = 0; k < p.mirror.size(); ++k) {
      const Vec<D> origin = p.mirror.image(k, Vec<D>::Zero());
      rule->normals_[n + static_cast<std::size_t>(k)] =
          p.mirror.image(k, rule->normals_[static_cast<std::size_t>(p.mirror.master(k))]) - origin;
    }
    return rule;
  }

  rule->by_material_ = interfaces != nullptr;
  const auto cells = static_cast<Index>(std::ceil(reach / lattice->spacing.minCoeff() + 1));
  rule->visibility_.emplace(lattice->size, labels_of(*lattice, interfaces), cells);
  const LatticeFrame<D> frame{cloud.X[0], lattice->spacing, lattice->site(0)};
  for (const auto& plane : planes)
    rule->visibility_->add_plane(plane.axis, frame.at(plane.axis, plane.at), plane.side);
  for (const auto& period : p.mirror.periods()) rule->visibility_->add_period(period.axis);
  rule->sites_.resize(total);
  for (std::size_t i = 0; i < n; ++i) rule->sites_[i] = lattice->site(static_cast<std::size_t>(p.id[i]));
  // Reflections and shifts of places are those of sites.
  for (Index k = 0; k < p.mirror.size(); ++k) {
    const Vec<D> image = p.mirror.image(k, frame.X);
    const Vec<D> beside = p.mirror.image(k, Vec<D>(frame.X + frame.spacing)) - image;
    const Site<D>& master = rule->sites_[static_cast<std::size_t>(p.mirror.master(k))];
    Site<D>& site = rule->sites_[n + static_cast<std::size_t>(k)];
    for (int d = 0; d < D; ++d) {
      const auto e = static_cast<std::size_t>(d);
      const Index off = master[e] - frame.site[e];
      site[e] = frame.at(d, image[d]) + (beside[d] < 0 ? -off : off);
    }
  }
  if (interfaces) {
    rule->label_.resize(total);
    for (std::size_t i = 0; i < n; ++i) rule->label_[i] = static_cast<std::uint8_t>(1 + p.material[i]);
    for (Index k = 0; k < p.mirror.size(); ++k)
      rule->label_[n + static_cast<std::size_t>(k)] =
          rule->label_[static_cast<std::size_t>(p.mirror.master(k))];
  }
  return rule;
}

template <int D>
bool PairRule<D>::leaves(Index a, Index b) const {
  const Vec<D>&na = normals_[static_cast<std::size_t>(a)], &nb = normals_[static_cast<std::size_t>(b)];
  const Vec<D> X =
      p_->X.template vec<D>(static_cast<std::size_t>(b)) - p_->X.template vec<D>(static_cast<std::size_t>(a));
  const double r = X.norm(), out_a = na.dot(X), out_b = -nb.dot(X);
  constexpr double away = 0.85, towards = 0.4;
  return out_a > away * r || out_b > away * r || (out_a > towards * r && out_b > towards * r);
}

template <int D>
bool PairRule<D>::counts(Index a, Index b) const {
  if (!visibility_) return !leaves(a, b);
  const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
  if (!label_.empty() && label_[i] != label_[j]) return false;
  return visibility_->connects(sites_[i], sites_[j], label_.empty() ? Visibility<D>::any : label_[i]);
}

template <int D>
bool PairRule<D>::same_body(Index a, Index b) const {
  if (!visibility_) return !leaves(a, b);
  return visibility_->connects(sites_[static_cast<std::size_t>(a)], sites_[static_cast<std::size_t>(b)],
                               Visibility<D>::any);
}

template <int D>
typename PairRule<D>::Sample PairRule<D>::sample(std::span<const Index> particles,
                                                 std::uint8_t material) const {
  Sample s;
  if (particles.size() == 1) s.particle = particles[0];
  s.label = by_material_ ? static_cast<std::uint8_t>(1 + material) : Visibility<D>::any;
  if (visibility_)
    for (std::size_t d = 0; d < D; ++d) {
      for (const Index i : particles) s.site[d] += sites_[static_cast<std::size_t>(i)][d];
      s.site[d] /= static_cast<Index>(particles.size());
    }
  return s;
}

template <int D>
bool PairRule<D>::sees(Index particle, const Sample& s) const {
  if (visibility_) return visibility_->connects(sites_[static_cast<std::size_t>(particle)], s.site, s.label);
  return s.particle == no_particle || s.particle == particle || !leaves(particle, s.particle);
}

template class PairRule<1>;
template class PairRule<2>;
template class PairRule<3>;

}  // namespace taut
