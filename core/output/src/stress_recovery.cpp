#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>
#include <numeric>
#include <taut/base/error.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/output/stress_recovery.hpp>
#include <taut/particles/pair_rule.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

namespace {

/// Disjoint sets of numbers, joined pair by pair.
class Groups {
 public:
  explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), Index{0}); }
  Index of(Index i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  void join(Index a, Index b) { parent(of(a)) = of(b); }

 private:
  Index& parent(Index i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<Index> parent_;
};

template <int D>
struct Patches {
  PatchPoints<D> targets, samples;
  std::vector<typename PairRule<D>::Sample> places;  ///< of the samples, where the particles have a rule
};

/// Particles and samples, in groups that the formulation couples and that are of one material.
template <int D>
Patches<D> find_patches(const SimulationImpl<D>& s) {
  const Particles<D>& p = s.particles;
  const auto material = [&](Index i) { return p.material[static_cast<std::size_t>(i)]; };
  Patches<D> patches;
  std::vector<std::vector<Index>> links;  // of each sample: the particles of its material that it touches
  std::vector<Index> touched_by(static_cast<std::size_t>(p.n), no_particle);
  bool cells = false;
  s.formulation->visit_stresses([&](const StressSample<D>& sample) {
    links.emplace_back();
    for (const Index i : sample.particles) {
      if (material(i) == sample.material) links.back().push_back(i);
      touched_by[static_cast<std::size_t>(i)] = static_cast<Index>(links.size()) - 1;
    }
    cells = cells || sample.particles.size() > 1;
    patches.samples.X.push_back(sample.X);
    if (p.rule) patches.places.push_back(p.rule->sample(sample.particles, sample.material));
  });
  Groups groups(static_cast<std::size_t>(p.n) + links.size());
  std::vector<bool> linked(static_cast<std::size_t>(p.n), false);
  for (std::size_t k = 0; k < links.size(); ++k)
    for (const Index i : links[k]) {
      groups.join(p.n + static_cast<Index>(k), i);
      linked[static_cast<std::size_t>(i)] = true;
    }
  if (!cells) {
    PairList pairs =
        find_pairs<D>(points_of<D>(p.X, p.n), s.method.support_dx * p.dx, {.coincident = !p.ties.empty()});
    if (p.rule) filter_pairs(pairs, [&](Index a, Index b) { return p.rule->counts(a, b); });
    for (Index i = 0; i < p.n; ++i)
      pairs.for_each(i, [&](Index b, std::int64_t, int) {
        if (b < i && material(b) == material(i)) groups.join(i, b);
      });
  }
  for (Index i = 0; i < p.n; ++i) {
    patches.targets.X.push_back(p.X.template vec<D>(static_cast<std::size_t>(i)));
    // A layer of a material that is thinner than its cells has the stress of those that hold it.
    const bool own = linked[static_cast<std::size_t>(i)];
    patches.targets.group.push_back(groups.of(own ? i : p.n + touched_by[static_cast<std::size_t>(i)]));
  }
  for (std::size_t k = 0; k < links.size(); ++k)
    patches.samples.group.push_back(groups.of(p.n + static_cast<Index>(k)));
  return patches;
}

template <int D>
PatchFit<D> make_fit(const SimulationImpl<D>& s, double support_dx) {
  if (!s.formulation) throw InputError("stress recovery: prepare, run or relax the simulation first");
  if (!(support_dx >= 2) || support_dx > 20)
    throw InputError(fmt::format("stress recovery: support_dx = {:g} must lie between 2 and 20", support_dx));
  const Patches<D> patches = find_patches(s);
  const Particles<D>& p = s.particles;
  std::function<bool(Index, Index)> sees;
  if (p.rule)
    sees = [&](Index target, Index sample) {
      return p.rule->sees(target, patches.places[static_cast<std::size_t>(sample)]);
    };
  return PatchFit<D>(patches.targets, patches.samples, support_dx * p.dx, sees, !p.ties.empty());
}

}  // namespace

template <int D>
StressRecovery<D>::StressRecovery(const Simulation<D>& simulation, double support_dx)
    : simulation_(&simulation.impl()), fit_(make_fit(*simulation_, support_dx)) {}

template <int D>
template <class F>
std::vector<Mat<D>> StressRecovery<D>::recover(F&& of_sample) const {
  std::vector<Mat<D>> samples;
  simulation_->formulation->visit_stresses(
      [&](const StressSample<D>& sample) { samples.push_back(of_sample(sample)); });
  const std::vector<Mat<D>> fitted = fit_(samples);
  const std::vector<Index>& place = simulation_->particles.place;
  std::vector<Mat<D>> ordered(place.size());
  for (std::size_t id = 0; id < place.size(); ++id) ordered[id] = fitted[static_cast<std::size_t>(place[id])];
  return ordered;
}

template <int D>
std::vector<Mat<D>> StressRecovery<D>::first_piola_kirchhoff() const {
  return recover([](const StressSample<D>& s) { return s.P; });
}

namespace {
template <int D>
Mat<3> cauchy_stress_of(const StressSample<D>& s, const Particles<D>& p) {
  // Only hyperelastic laws have samples.
  return dynamic_cast<const Hyperelastic<D>&>(*p.materials[s.material]).cauchy_stress(s.F);
}
}  // namespace

template <int D>
std::vector<Mat<D>> StressRecovery<D>::cauchy_stress() const {
  return recover([&](const StressSample<D>& s) {
    return Mat<D>(cauchy_stress_of(s, simulation_->particles).template topLeftCorner<D, D>());
  });
}

template <int D>
std::vector<Mat<3>> StressRecovery<D>::full_cauchy_stress() const {
  const std::vector<Mat<D>> in_plane = cauchy_stress();
  std::vector<Mat<3>> sigma(in_plane.size(), Mat<3>::Zero());
  for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i].template topLeftCorner<D, D>() = in_plane[i];
  for (int k = D; k < 3; ++k) {
    const std::vector<Mat<D>> lateral = recover([&](const StressSample<D>& s) {
      return Mat<D>(Mat<D>::Constant(cauchy_stress_of(s, simulation_->particles)(k, k)));
    });
    for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i](k, k) = lateral[i](0, 0);
  }
  return sigma;
}

template class StressRecovery<1>;
template class StressRecovery<2>;
template class StressRecovery<3>;

}  // namespace taut
