#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <taut/base/error.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/formulations/registry.hpp>

namespace taut {

template <int D>
std::unique_ptr<Formulation<D>> make_formulation(const FormulationSetup<D>& setup) {
  const FormulationEntry& entry = formulation_registry().find(setup.method.formulation);
  for (const auto& material : setup.particles.materials)
    if (kind_of(*material) != entry.traits.material)
      throw InputError(fmt::format("{} needs {}; \"{}\" gives {}. Valid: {}", entry.name,
                                   describe(entry.traits.material), material->name(),
                                   entry.traits.material == MaterialKind::stress
                                       ? "stress rates"
                                       : "stresses of a deformation gradient",
                                   join_names(material_names(entry.traits.material))));
  return maker_of<D>(entry, "formulation")(setup);
}

namespace {
// For each particle the nearest one that stands near by in memory, where order follows place: within the
// reach of its pairs if it can be. Lone particles are their own companions.
template <int D>
std::vector<Index> companions(const Particles<D>& p, double reach) {
  constexpr Index near = 4, far = 2048;
  std::vector<Index> companion(static_cast<std::size_t>(p.n));
#pragma omp parallel for schedule(static) if (p.n > 65536)
  for (Index i = 0; i < p.n; ++i) {
    const Vec<D> X = p.X.template vec<D>(i);
    Index nearest = i;
    double least = reach * reach;
    for (Index k = 1; k <= far && (k <= near || nearest == i); ++k)
      for (const Index j : {i - k, i + k}) {
        if (j < 0 || j >= p.n) continue;
        const double r2 = (p.X.template vec<D>(j) - X).squaredNorm();
        if (!(r2 < least)) continue;
        least = r2;
        nearest = j;
      }
    companion[static_cast<std::size_t>(i)] = nearest;
  }
  return companion;
}
}  // namespace

template <int D>
Formulation<D>::Formulation(const FormulationSetup<D>& setup)
    : p_(setup.particles),
      constraints_(setup.constraints),
      loads_(setup.loads),
      method_(setup.method),
      companion_(companions<D>(setup.particles, setup.method.support_dx * setup.particles.dx)) {
  this->set_motion(p_.u.flat(), p_.v.flat(), p_.a.flat(), p_.m_flat.flat());
}

template <int D>
void Formulation<D>::finish_accelerations(double t) {
  loads_.add_to(t, p_.m, p_.a);
  if (!p_.ties.empty()) p_.tie(p_.a);
  constraints_.apply_to_accelerations(p_.a);
}

template <int D>
void Formulation<D>::inspect() {
  // Neighbours of no elastic body part faster than its waves by this much; those that do are flying apart.
  // However fast a body flies or spins as a whole, they do not part.
  constexpr double runaway = 20;
  const double speed = p_.wave_speed();
  for (Index i = 0; i < p_.n; ++i) {
    const Vec<D> v = p_.v.template vec<D>(i);
    const double apart = (v - p_.v.template vec<D>(companion_[static_cast<std::size_t>(i)])).squaredNorm();
    if (apart <= runaway * runaway * speed * speed) continue;
    const bool finite = v.allFinite();
    if (!finite || std::isfinite(apart)) {
      failure_ = Failure{finite ? "runaway energy" : "not a number", i};
      return;
    }
    // Of the two it is the companion that is no number, or their difference that overflows.
    const Index other = companion_[static_cast<std::size_t>(i)];
    const bool both = p_.v.template vec<D>(other).allFinite();
    failure_ = Failure{both ? "runaway energy" : "not a number", both ? i : other};
    return;
  }
}

template <int D>
Mat<3> Formulation<D>::full_cauchy_stress(Index i) const {
  Mat<3> sigma = Mat<3>::Zero();
  sigma.template topLeftCorner<D, D>() = cauchy_stress(i);
  const Plane plane = p_.materials[p_.material[static_cast<std::size_t>(i)]]->parameters().plane;
  if (!(D == 2 && plane == Plane::stress))
    for (int k = D; k < 3; ++k) sigma(k, k) = std::numeric_limits<double>::quiet_NaN();
  return sigma;
}

template <int D>
Mat<D> Formulation<D>::deformation_gradient(Index) const {
  throw InputError(fmt::format("{} has no deformation gradient: it keeps no reference configuration",
                               method_.formulation));
}

template <int D>
Mat<D> Formulation<D>::first_piola_kirchhoff(Index) const {
  throw InputError(fmt::format("{} has no first Piola-Kirchhoff stress: it keeps no reference configuration",
                               method_.formulation));
}

template <int D>
void Formulation<D>::visit_stresses(const std::function<void(const StressSample<D>&)>&) const {
  throw InputError(fmt::format(
      "{} keeps no reference configuration, in which stresses could be recovered; total Lagrangian forms do",
      method_.formulation));
}

template <int D>
double Formulation<D>::strain_energy() const {
  throw InputError(fmt::format("{} has no stored energy", method_.formulation));
}

#define TAUT_INSTANTIATE(D)      \
  template class Formulation<D>; \
  template std::unique_ptr<Formulation<D>> make_formulation<D>(const FormulationSetup<D>&);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
