#pragma once
/// \file
/// What the updated Lagrangian forms share: density and stress by rates, and the pair loops on current
/// positions.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <taut/base/disjoint_sets.hpp>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/base/simd.hpp>
#include <taut/formulations/health_sweeps.hpp>
#include <taut/formulations/registry.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/kernels/kernel_table.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/neighbors/verlet_list.hpp>
#include <taut/particles/material_groups.hpp>

namespace taut {

/// Row and column of component c of a symmetric tensor in the storage order of `sym_components`.
template <int D>
constexpr std::array<int, 2> sym_axes(int c) {
  constexpr int three[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
  constexpr int two[3][2] = {{0, 0}, {1, 1}, {0, 1}};
  return D == 2 ? std::array<int, 2>{two[c][0], two[c][1]} : std::array<int, 2>{three[c][0], three[c][1]};
}

/// Updated Lagrangian SPH for hypoelastic materials (Gray, Monaghan & Swift 2001):
///   L_a = 1/rho_a sum_b m_b (v_b - v_a) (x) grad W_ab,   drho_a/dt = -rho_a tr L_a,   ds/dt by the material,
///   dv_a/dt = sum_b m_b (T_a + T_b + pair terms) grad W_ab,   T = sigma / rho^2.
/// L is the adjoint of the force, so what work the forces do is the stress power. In plane stress rho is the
/// mass per area of the plane, the material has a density of its own, and T = sigma / (rho rho_material).
template <int D>
class UpdatedLagrangian : public Formulation<D> {
 protected:
  using Base = Formulation<D>;
  using Base::p_;
  static constexpr int S = sym_components<D>;
  static constexpr int chunk = chunk_particles;

 public:
  explicit UpdatedLagrangian(const FormulationSetup<D>& setup);

  void update_rates(double t) override;
  void inspect() override;

  Fastest fastest() const override {
    const double speed = p_.wave_speed();
    return {.wave_speed = speed * (1 + 0.6 * this->method_.viscosity), .length = h_};
  }
  Mat<D> cauchy_stress(Index i) const override {
    return full_cauchy_stress(i).template topLeftCorner<D, D>();
  }
  Mat<3> full_cauchy_stress(Index i) const override {
    Mat<D> s;
    for (int c = 0; c < S; ++c) {
      const auto [r, q] = sym_axes<D>(c);
      s(r, q) = s(q, r) = s_.component(c)[i];
    }
    return materials_[p_.material[static_cast<std::size_t>(i)]]->cauchy_stress(s,
                                                                               rho_material_.component(0)[i]);
  }
  std::vector<Index> bodies() const override {
    DisjointSets sets(p_.n);
    const double support = table_.support();
    for (Index a = 0; a < p_.n; ++a)
      list_.pairs().for_each(a, [&](Index b, std::int64_t, int) {
        if ((p_.X.template vec<D>(a) - p_.X.template vec<D>(b)).norm() < support)
          sets.join(a, b < p_.n ? b : p_.mirror.master(b - p_.mirror.begin()));
      });
    return sets.numbers();
  }
  void check(Health& health) const override { check_updated_operator<D>(p_, list_.pairs(), table_, health); }
  MotionSample motion() const override { return updated_motion<D>(p_, nearest_, rho_); }
  double rough_limit() const override { return 0.025; }
  std::int64_t pairs() const override { return list_.pairs().pairs(); }
  std::int64_t rebuilds() const override { return list_.builds() - 1; }
  std::size_t bytes() const override {
    return list_.pairs().bytes() + x_.bytes() + rho_.bytes() * 2 + rho_material_.bytes() * 2 +
           s_.bytes() * 2 + T_.bytes();
  }

 protected:
  PointView<D> points() const { return points_of<D>(x_, p_.total); }
  /// x = X + u of all particles, mirror images included.
  void update_positions();
  /// Finds the images of the particles where these are now, after what has left a period was brought back.
  void follow_images();
  /// Brings the pair list up to date; false, with `failure` set, where the particles are in no state to have
  /// one.
  bool update_list();
  /// T = sigma / rho^2 of all particles, mirror images included.
  void update_stress();
  /// dv/dt. `term.add(i, r2, at, T)` adds to the symmetric components T = T_a + T_b of the pairs of particles
  /// i ... i + 7 with the neighbours that `at` loads, r2 their squared distances.
  template <class Term>
  void acceleration_pass(const Term& term);
  /// Calls f(at) for each slot of slice s; at(p) are the values of a component p at the slot's neighbours.
  template <class F>
  TAUT_INLINE void for_slots(Index s, F&& f) const {
    const PairList& pairs = list_.pairs();
    for (std::int64_t k = pairs.begin(s); k < pairs.gathered(s); ++k) {
      f([first = pairs.first(k)](const double* p) TAUT_INLINE_LAMBDA { return load(p + first); });
    }
    for (std::int64_t k = pairs.gathered(s); k < pairs.begin(s + 1); ++k) {
      const Index* at = pairs.block(k);
      f([at](const double* p) TAUT_INLINE_LAMBDA { return gather(p, at); });
    }
  }

  MaterialGroups groups_;
  Kernel kernel_;
  double h_;
  KernelTable table_;
  std::vector<const Hypoelastic<D>*> materials_;
  VerletList<D> list_;
  Field x_;  ///< current positions, as of the last `update_rates`
  Field rho_, rho_rate_, rho_material_, rho_material_rate_, s_, s_rate_, T_;
  std::vector<std::array<Index, 2>> nearest_;  // pairs that touch in the reference configuration
};

inline FormulationTraits updated_lagrangian_traits() {
  return {.reference = Reference::updated,
          .operators = false,
          .material = MaterialKind::rate,
          .energy = false,
          .support_dx = 2.4};  // particles change neighbours: fewer would leave gaps
}

/// The parameters that these forms share.
inline std::vector<Parameter> updated_lagrangian_parameters() {
  std::vector<Parameter> all = pair_parameters(updated_lagrangian_traits());
  all.push_back(number_parameter("viscosity", 0, Interval::non_negative(), "", "Monaghan's α; 0 = absent"));
  all.push_back(number_parameter("skin", 0.1, {0, 2}, "R", "skin of the pair list over the support radius"));
  all.push_back(choice_parameter("velocity_gradient", "standard", {"standard", "corrected"},
                                 "plain, or linearly exact"));
  return all;
}

/// The term of plain SPH: nothing.
struct NoPairTerm {
  static constexpr bool present = false;
};

template <int D>
UpdatedLagrangian<D>::UpdatedLagrangian(const FormulationSetup<D>& setup)
    : Base(setup),
      groups_(p_),
      kernel_(setup.method.kernel, D),
      h_(setup.method.support_dx * p_.dx / kernel_.radius_factor()),
      table_(kernel_, h_),
      list_(setup.method.support_dx * p_.dx, setup.method.skin, {search_method(setup.method.neighbours)}) {
  for (const auto& material : p_.materials)  // of the kind that the traits ask for
    materials_.push_back(&dynamic_cast<const Hypoelastic<D>&>(*material));
  const std::size_t n = p_.X.particles();  // there is room for more images
  rho_ = rho_rate_ = rho_material_ = rho_material_rate_ = Field(n, 1);
  s_ = s_rate_ = T_ = Field(n, S);
  this->add_variable(rho_.flat(), rho_rate_.flat());
  this->add_variable(rho_material_.flat(), rho_material_rate_.flat());
  this->add_variable(s_.flat(), s_rate_.flat());
  std::fill(rho_.flat().begin(), rho_.flat().end(), 1.0);
  std::fill(rho_material_.flat().begin(), rho_material_.flat().end(), 1.0);
  for (Index i = 0; i < p_.n; ++i)
    rho_.component(0)[i] = rho_material_.component(0)[i] =
        p_.materials[p_.material[static_cast<std::size_t>(i)]]->density();
  x_ = Field(n, D);
  update_positions();
  list_.update(points());
  // Slightly more than the spacing of the lattice: what is adjacent along its axes.
  const double touching = 1.2 * p_.dx;
  for (Index a = 0; a < p_.n; ++a)
    list_.pairs().for_each(a, [&](Index b, std::int64_t, int) {
      if (b > a && b < p_.n && (p_.X.template vec<D>(a) - p_.X.template vec<D>(b)).norm() < touching)
        nearest_.push_back({a, b});
    });
}

template <int D>
void UpdatedLagrangian<D>::update_positions() {
  const auto n = static_cast<std::int64_t>(x_.flat().size());
  const double *X = p_.X.data(), *u = p_.u.data();
  double* x = x_.data();
#pragma omp parallel for simd schedule(static) if (p_.n > parallel_from)
  for (std::int64_t i = 0; i < n; ++i) x[i] = X[i] + u[i];
  if (!p_.mirror.empty()) p_.mirror.positions(x_);
}

template <int D>
void UpdatedLagrangian<D>::follow_images() {
  if (!p_.mirror.periods().empty())
    for (Index i = 0; i < p_.n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      const Vec<D> shift = p_.mirror.wrap(x_.template vec<D>(k));
      if (shift.isZero(0)) continue;
      // Displacements stay what they are: another period of the reference is where it comes from.
      p_.X.template set_vec<D>(k, p_.X.template vec<D>(k) + shift);
      x_.template set_vec<D>(k, p_.X.template vec<D>(k) + p_.u.template vec<D>(k));
    }
  p_.mirror.follow(x_, p_.n);
  const auto room = static_cast<Index>(p_.X.particles());
  if (p_.n + p_.mirror.size() > room) {
    this->failure_ = Failure{"more images than there is room for", p_.mirror.master(room - p_.n)};
    return;
  }
  p_.total = p_.n + p_.mirror.size();
  for (Index k = p_.n; k < room; ++k) {
    p_.X.template set_vec<D>(static_cast<std::size_t>(k), Vec<D>::Constant(1e30 * p_.dx));
    p_.u.template set_vec<D>(static_cast<std::size_t>(k), Vec<D>::Zero());
    x_.template set_vec<D>(static_cast<std::size_t>(k), Vec<D>::Constant(1e30 * p_.dx));
  }
  p_.mirror.positions(x_);
  p_.mirror.vectors(p_.v);
  p_.mirror.scalars(p_.m);
}

template <int D>
bool UpdatedLagrangian<D>::update_list() {
  if (this->failure_) return false;
  for (Index i = 0; i < p_.n; ++i)
    if (!x_.template vec<D>(i).allFinite()) {
      this->failure_ = Failure{"not a number", i};
      return false;
    }
  if (p_.mirror.possible() && list_.due(points())) follow_images();
  if (this->failure_) return false;
  try {
    list_.update(points());
    return true;
  } catch (const CoincidentPoints&) {
    // Report the pair of the last list that came closest.
    Failure closest{"coincident particles", 0};
    double least = std::numeric_limits<double>::max();
    for (Index a = 0; a < p_.n; ++a)
      list_.pairs().for_each(a, [&](Index b, std::int64_t, int) {
        const double r2 = (x_.template vec<D>(a) - x_.template vec<D>(b)).squaredNorm();
        if (r2 < least) {
          least = r2;
          closest.particle = a;
        }
      });
    this->failure_ = closest;
    return false;
  } catch (const InputError& error) {
    this->failure_ = Failure{std::string("no list of neighbours: ") + error.what(), 0};
    return false;
  }
}

template <int D>
void UpdatedLagrangian<D>::inspect() {
  Base::inspect();
  if (this->failure_) return;
  // The widest gap is where the body tears.
  double widest = table_.support() * table_.support();
  for (const auto& [a, b] : nearest_) {
    const Vec<D> x_ab = x_.template vec<D>(a) - x_.template vec<D>(b);
    const double r2 = p_.mirror.nearest(x_ab).squaredNorm();
    if (r2 <= widest) continue;
    widest = r2;
    this->failure_ = Failure{"lost neighbours", a};
  }
}

/// Inverse of eight D×D matrices (row-major).
template <int D>
TAUT_INLINE void invert(const Pack (&A)[D * D], Pack (&B)[D * D]) {
  if constexpr (D == 1) {
    B[0] = 1 / A[0];
  } else if constexpr (D == 2) {
    const Pack d = 1 / (A[0] * A[3] - A[1] * A[2]);
    B[0] = A[3] * d;
    B[1] = -A[1] * d;
    B[2] = -A[2] * d;
    B[3] = A[0] * d;
  } else {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const int r = (j + 1) % 3, q = (j + 2) % 3, u = (i + 1) % 3, w = (i + 2) % 3;
        B[i * 3 + j] = A[r * 3 + u] * A[q * 3 + w] - A[r * 3 + w] * A[q * 3 + u];
      }
    const Pack d = 1 / (A[0] * B[0] + A[1] * B[3] + A[2] * B[6]);
    for (auto& b : B) b *= d;
  }
}

template <int D>
void UpdatedLagrangian<D>::update_rates(double) {
  update_positions();
  if (!p_.mirror.empty()) p_.mirror.vectors(p_.v);
  if (!update_list()) return;
  const bool corrected = this->method_.velocity_gradient == "corrected";
  const double* m = p_.m.component(0);
  parallel_for(groups_.chunks(), p_.n > parallel_from, [&](Index c) {
    alignas(64) double L[D * D * chunk], trace[chunk];
    const Index first = groups_.first_slice(c), last = groups_.last_slice(c);
    for (Index s = first; s < last; ++s) {
      const Index i = s * lanes;
      Pack xi[D], vi[D], sum[D * D], moment[D * D];
      for (int d = 0; d < D; ++d) {
        xi[d] = load(x_.component(d) + i);
        vi[d] = load(p_.v.component(d) + i);
      }
      for (int k = 0; k < D * D; ++k) sum[k] = moment[k] = pack(0);
      for_slots(s, [&](auto&& at) TAUT_INLINE_LAMBDA {
        Pack xab[D], vab[D], r2 = pack(0);
        for (int d = 0; d < D; ++d) {
          xab[d] = at(x_.component(d)) - xi[d];
          vab[d] = at(p_.v.component(d)) - vi[d];
          r2 += xab[d] * xab[d];
        }
        const Pack w = -at(m) * table_.slope_over_r(r2);
        for (int e = 0; e < D; ++e) {
          const Pack g = w * xab[e];
          for (int d = 0; d < D; ++d) {
            sum[d * D + e] += vab[d] * g;
            if (corrected) moment[e * D + d] += g * xab[d];
          }
        }
      });
      Pack Li[D * D];
      if (corrected) {
        Pack K[D * D];
        invert<D>(moment, K);
        for (int d = 0; d < D; ++d)
          for (int e = 0; e < D; ++e) {
            Li[d * D + e] = sum[d * D] * K[e * D];
            for (int j = 1; j < D; ++j) Li[d * D + e] += sum[d * D + j] * K[e * D + j];
          }
      } else {
        for (int k = 0; k < D * D; ++k) Li[k] = sum[k] / load(rho_.component(0) + i);
      }
      if (i + lanes > p_.n)
        for (int l = p_.n - i; l < lanes; ++l)
          for (auto& component : Li) component[l] = 0;
      Pack tr = Li[0];
      for (int d = 1; d < D; ++d) tr += Li[d * (D + 1)];
      const int at = (s - first) * lanes;
      for (int k = 0; k < D * D; ++k) store(L + k * chunk + at, Li[k]);
      store(trace + at, tr);
    }
    const int n = (last - first) * lanes;
    const Index begin = first * lanes;
    // The material's blocks: stress components, then its density rate.
    alignas(64) double s_in[S * chunk], rates[(S + 1) * chunk];
    for (int k = 0; k < S; ++k) std::copy_n(s_.component(k) + begin, n, s_in + k * chunk);
    groups_.template call<S + 1>(c, rates, [&](std::size_t material, double* out) {
      RateBlock<D> block;
      block.n = n;
      block.stride = chunk;
      block.L = L;
      block.s = s_in;
      block.rho = rho_material_.component(0) + begin;
      block.s_rate = out;
      block.rho_rate = out + S * chunk;
      materials_[material]->rate(block);
    });
    for (int k = 0; k < S; ++k) std::copy_n(rates + k * chunk, n, s_rate_.component(k) + begin);
    std::copy_n(rates + S * chunk, n, rho_material_rate_.component(0) + begin);
    const double* rho = rho_.component(0) + begin;
    double* rate = rho_rate_.component(0) + begin;
    for (int i = 0; i < n; ++i) rate[i] = -rho[i] * trace[i];
  });
}

template <int D>
void UpdatedLagrangian<D>::update_stress() {
  Index broken = p_.n;
  const auto of_chunk = [&](Index c, Index& first_broken) {
    const int n = (groups_.last_slice(c) - groups_.first_slice(c)) * lanes;
    const Index begin = groups_.first(c);
    alignas(64) double s_in[S * chunk], sigma[S * chunk];
    for (int k = 0; k < S; ++k) std::copy_n(s_.component(k) + begin, n, s_in + k * chunk);
    groups_.template call<S>(c, sigma, [&](std::size_t material, double* out) {
      RateBlock<D> block;
      block.n = n;
      block.stride = chunk;
      block.s = s_in;
      block.rho = rho_material_.component(0) + begin;
      block.sigma = out;
      materials_[material]->stress(block);
    });
    const double *rho = rho_.component(0) + begin, *rho_m = rho_material_.component(0) + begin;
    for (int k = 0; k < S; ++k) {
      double* T = T_.component(k) + begin;
      for (int i = 0; i < n; ++i) T[i] = sigma[k * chunk + i] / (rho[i] * rho_m[i]);
    }
    for (int i = 0; i < n; ++i)
      if (!(rho[i] > 0 && rho_m[i] > 0)) first_broken = std::min<Index>(first_broken, begin + i);
  };
  parallel_for(groups_.chunks(), p_.n > parallel_from, p_.n, of_chunk,
               [&](Index first_broken) { broken = std::min(broken, first_broken); });
  if (!p_.mirror.empty()) {
    p_.mirror.symmetric(T_);
    p_.mirror.scalars(rho_);
    p_.mirror.scalars(rho_material_);
  }
  if (broken < p_.n && !this->failure_)
    this->failure_ =
        Failure{std::isfinite(rho_.component(0)[broken]) ? "density <= 0" : "not a number", broken};
}

template <int D>
template <class Term>
void UpdatedLagrangian<D>::acceleration_pass(const Term& term) {
  const double* m = p_.m.component(0);
  const double alpha = this->method_.viscosity;
  const double* rho = rho_.component(0);
  const double speed = p_.wave_speed();
#pragma omp parallel for schedule(static) if (p_.n > parallel_from)
  for (Index s = 0; s < groups_.slices(); ++s) {
    const Index i = s * lanes;
    Pack xi[D], vi[D], Ti[S], a[D];
    for (int d = 0; d < D; ++d) {
      xi[d] = load(x_.component(d) + i);
      vi[d] = load(p_.v.component(d) + i);
      a[d] = pack(0);
    }
    for (int k = 0; k < S; ++k) Ti[k] = load(T_.component(k) + i);
    const Pack rho_i = load(rho + i);
    for_slots(s, [&](auto&& at) TAUT_INLINE_LAMBDA {
      Pack xab[D], r2 = pack(0);
      for (int d = 0; d < D; ++d) {
        xab[d] = at(x_.component(d)) - xi[d];
        r2 += xab[d] * xab[d];
      }
      const Pack w = -at(m) * table_.slope_over_r(r2);
      Pack T[S];
      for (int k = 0; k < S; ++k) T[k] = Ti[k] + at(T_.component(k));
      if constexpr (Term::present) term.add(i, r2, at, T);
      if (alpha > 0) {
        Pack approach = pack(0);
        for (int d = 0; d < D; ++d) approach += (at(p_.v.component(d)) - vi[d]) * xab[d];
        // Monaghan 1992: Pi = -alpha c h v.x / (r^2 + 0.01 h^2) / mean density, for approaching pairs.
        const Pack pi = alpha * speed * h_ * approach / ((r2 + 0.01 * h_ * h_) * (0.5 * (rho_i + at(rho))));
        const Pack push = approach < 0 ? pi : pack(0);
        for (int k = 0; k < D; ++k) T[k] += push;
      }
      Pack g[D];
      for (int d = 0; d < D; ++d) g[d] = w * xab[d];
      if constexpr (D == 1) {
        a[0] += T[0] * g[0];
      } else if constexpr (D == 2) {
        a[0] += T[0] * g[0] + T[2] * g[1];
        a[1] += T[2] * g[0] + T[1] * g[1];
      } else {
        a[0] += T[0] * g[0] + T[5] * g[1] + T[4] * g[2];
        a[1] += T[5] * g[0] + T[1] * g[1] + T[3] * g[2];
        a[2] += T[4] * g[0] + T[3] * g[1] + T[2] * g[2];
      }
    });
    for (int d = 0; d < D; ++d) {
      if (i + lanes > p_.n)
        for (int l = p_.n - i; l < lanes; ++l) a[d][l] = 0;
      store(p_.a.component(d) + i, a[d]);
    }
  }
}

}  // namespace taut
