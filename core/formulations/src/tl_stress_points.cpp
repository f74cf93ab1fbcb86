#include <fmt/format.h>
#include <omp.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <taut/base/describe.hpp>
#include <taut/base/disjoint_sets.hpp>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/formulations/cell_kinematics.hpp>
#include <taut/formulations/cell_strips.hpp>
#include <taut/formulations/formulations.hpp>
#include <taut/formulations/hyperelastic_form.hpp>
#include <taut/formulations/power_iteration.hpp>
#include <taut/formulations/rest_stiffness.hpp>

namespace taut {

namespace {

/// Total Lagrangian form whose stresses live on the cells between the particles (stress points: Belytschko,
/// Guo, Liu & Xiao 2000; Rabczuk, Belytschko & Xiao 2004). A cell of volume V_q(X), with corners I and B_qI =
/// dV_q/dX_I, has the mean gradient of Flanagan & Belytschko (1981),
///   F_q = I + 1/V_q sum_I u_I (x) B_qI,   f_I = -sum_q P_q B_qI,
/// which is exact for linear fields; forces are its adjoint, and those of a constant stress cancel inside
/// (sum_q B_qI = 0) however irregular the cells are, for together they fill space. Nothing is stored for a
/// cell: B is one for strips of equal boxes, and else made from the corners' modes in every step.
///
/// What F_q does not see are the hourglass modes, q_m = u_m - (F_q - I) X_m with the modes of cell_modes.hpp.
/// They get the energy 1/2 sum_m k_m |q_m|^2, which is zero for linear fields and does not change under
/// rotations. With k = E / (3 D) sum |b_m|^2 / V a bent square, or cube, has the energy of a beam: no shear,
/// and a section that is free to contract (assumed strain: Belytschko & Bindeman 1991, 1993).
template <int D>
class TlStressPoints final : public HyperelasticForm<D> {
  using Base = HyperelasticForm<D>;
  using Base::materials_;
  using Base::p_;
  using Strip = typename CellStrips<D>::Strip;
  using Visit = typename CellStrips<D>::Visit;
  static constexpr int rows = CellStrips<D>::rows;
  static constexpr int chunk_packs = 4, chunk = chunk_packs * lanes;  // cells that a material call sees

 public:
  explicit TlStressPoints(const FormulationSetup<D>& setup);

  void update_accelerations(double) override;

  Mat<D> deformation_gradient(Index i) const override {
    return mean<D>(i, [](auto&, const Mat<D>& F, const Mat<D>&) { return F; });
  }
  Mat<D> first_piola_kirchhoff(Index i) const override {
    return mean<D>(i, [](auto&, const Mat<D>&, const Mat<D>& P) { return P; });
  }
  Mat<D> cauchy_stress(Index i) const override {
    return full_cauchy_stress(i).template topLeftCorner<D, D>();
  }
  Mat<3> full_cauchy_stress(Index i) const override {
    return mean<3>(i, [](auto& law, const Mat<D>& F, const Mat<D>&) { return law.cauchy_stress(F); });
  }
  /// Those of the cells, at the mean of their corners.
  void visit_stresses(const std::function<void(const StressSample<D>&)>& f) const override;
  /// That of the hourglass modes included.
  double strain_energy() const override;
  MotionSample motion() const override;
  double rough_limit() const override { return 0.1; }

  std::vector<Index> bodies() const override {
    DisjointSets sets(p_.n);
    for (const Strip& s : cells_.strips())
      for (const Index row : s.row)
        for (Index j = 0; j <= s.count; ++j) sets.join(s.row[0], row + j);
    return sets.numbers();
  }
  std::int64_t pairs() const override { return cells_.cells() * cell_corners<D>; }
  std::size_t bytes() const override {
    std::size_t visits = 0;
    for (const auto& part : parts_) visits += part.size();
    return cells_.bytes() + per_mass_.bytes() + visits * sizeof(Visit);
  }

 private:
  /// What a sweep over the cells makes of their gradients: the body's stresses, or those of
  /// `stiffest_mode`.
  struct ElasticLaw;
  struct LawAtRest;

  template <class Cells, class Law>
  void sweep_strip(const Visit& visit, const Columns<D>& u, Law& law) const;
  template <class Law>
  void sweep_part(const std::vector<Visit>& part, const Field& u, Law& law) const;

  /// Calls f with a `BoxCells` or `SkewCells` of cells j to j + 7 of a strip.
  template <class F>
  auto with_cells(const Strip& s, Index j, F&& f) const {
    const Columns<D> X(p_.X);
    return s.regular ? f(BoxCells<D>(s, j, X)) : f(SkewCells<D>(s, j, X));
  }
  Pack share(const Strip& s, Index j) const {
    const double* shares = cells_.shares(s);
    return shares ? load(shares + j) : pack(1);
  }
  template <int N, class F>
  Mat<N> mean(Index i, F&& f) const;
  /// Calls f(l, F, P) for the first `count` of the cells that `cells` holds, of strip s from j on.
  template <class Cells, class F>
  void with_stresses(const Strip& s, Index j, const Cells& cells, Index count, F&& f) const;
  void check_volumes() const;
  void share_out();
  double stiffest_mode(const LawsAtRest& laws);

  double control_ = 1;
  std::vector<double> stiffness_;  // of the first hourglass mode, over sum |b_m|^2 / V, of each material
  CellStrips<D> cells_;
  std::vector<std::vector<Visit>> parts_;  // one a thread
  int threads_ = 0;                        // that parts_ are made for
  Field per_mass_;
};

template <int D>
TlStressPoints<D>::TlStressPoints(const FormulationSetup<D>& setup) : Base(setup) {
  const double control = control_ = setup.method.zero_energy_control.value_or(1);
  for (const auto* material : materials_) {
    const MaterialParameters& m = material->parameters();
    const double bending = D == 2 && m.plane == Plane::strain ? m.E / (1 - m.nu * m.nu) : m.E;
    stiffness_.push_back(control * bending / (3 * D));
  }
  if (p_.cells.empty())
    throw InputError(
        "tl_stress_points needs the cells between the particles, which make_cloud lists for node-centred "
        "lattices with LatticeOptions::cells = true. Cell-centred lattices and clouds from files have none: "
        "use tl_displacement with compatible operators there");
  cells_ = CellStrips<D>(p_);
  p_.cells = {};
  p_.cell_share = {};
  p_.cell_material = {};
  check_volumes();
  per_mass_ = Field(static_cast<std::size_t>(p_.n), 1);
  // Cells end at symmetry planes, and so does the mass that they move.
  for (Index i = 0; i < p_.n; ++i)
    per_mass_.component(0)[i] = 1 / (p_.m.component(0)[i] * p_.modelled_share(i));
  this->frequency_ =
      highest_frequency<D>(materials_, [this](const LawsAtRest& laws) { return stiffest_mode(laws); });
}

template <int D>
void TlStressPoints<D>::check_volumes() const {
  for (const Strip& s : cells_.strips())
    for (Index j = 0; j < s.count; ++j) {
      const double V = with_cells(s, j, [](const auto& cells) { return cells.volume()[0]; });
      if (V > 0) continue;
      const Index i = s.row[0] + j;
      throw InputError(fmt::format(
          "the cell whose first corner is particle {} at {} has volume {:g}: is it turned inside out?",
          p_.id[i], describe<D>(p_.reference_position(i)), V));
    }
}

/// The parts of the sweeps for as many threads as there are; the same ones while these do not change.
template <int D>
void TlStressPoints<D>::share_out() {
  const int threads = p_.n > parallel_from ? omp_get_max_threads() : 1;
  if (threads == threads_) return;
  parts_ = cells_.parts(threads);
  threads_ = threads;
}

template <int D>
struct TlStressPoints<D>::ElasticLaw {
  const TlStressPoints& of;
  StretchExtremes<D> extremes{};
  Index inverted = std::numeric_limits<Index>::max();  // first corner of the first cell that broke

  TAUT_INLINE void see(const Strip& s, Index j, const Pack (&F)[D * D]) {
    const Pack J = extremes.add(F);
    if (!any(~(J > 0))) return;
    for (int l = 0; l < std::min<Index>(lanes, s.count - j); ++l)
      if (!(J[l] > 0)) inverted = std::min(inverted, s.row[0] + j + l);
  }
  void stress(const Strip& s, const StressBlock<D>& block) const { of.materials_[s.material]->stress(block); }
};

template <int D>
struct TlStressPoints<D>::LawAtRest {
  const LawsAtRest& laws;

  TAUT_INLINE void see(const Strip&, Index, const Pack (&)[D * D]) {}
  void stress(const Strip& s, const StressBlock<D>& block) const {
    laws[s.material].template stress<D>(block);
  }
};

// Adds the forces of one strip to the rows that are the visitor's.
template <int D>
template <class Cells, class Law>
TAUT_INLINE void TlStressPoints<D>::sweep_strip(const Visit& visit, const Columns<D>& u, Law& law) const {
  const Strip& s = cells_.strips()[static_cast<std::size_t>(visit.strip)];
  const Columns<D> X(p_.X);
  const double stiffness = stiffness_[s.material];
  double* a[D];
  for (int d = 0; d < D; ++d) a[d] = p_.a.component(d);

  Pack upper[rows][D];  // forces of the last pack on its upper corners along x
  for (int r = 0; r < rows; ++r)
    for (int d = 0; d < D; ++d) upper[r][d] = pack(0);
  for (Index begin = 0; begin < s.count; begin += chunk) {
    alignas(64) double F[D * D * chunk], H_diagonal[D * chunk], P[D * D * chunk];
    Bends<D> bends[chunk_packs];
    Cells cells[chunk_packs];
    const int packs = (std::min<Index>(chunk, s.count - begin) + lanes - 1) / lanes;
    for (int k = 0; k < packs; ++k) {
      const Index j = begin + k * lanes;
      Pack modes[D][cell_corners<D>], f[D * D];
      cells[k] = Cells(s, j, X);
      load_modes<D>(s, j, u, modes);
      cells[k].deform(modes, f, bends[k]);
      deform<D>(f, chunk, F + k * lanes, H_diagonal + k * lanes);
      law.see(s, j, f);
    }
    law.stress(s, {packs * lanes, chunk, F, P, nullptr, H_diagonal});
    for (int k = 0; k < packs; ++k) {
      const Index j = begin + k * lanes;
      Pack force[D][cell_corners<D>];
      cells[k].forces(P + k * lanes, chunk, bends[k], stiffness * cells[k].stiffness(), share(s, j), force);
      for (int d = 0; d < D; ++d) modes_to_corners<D>(force[d]);
      const Index left = s.count - j;
      for (int r = 0; r < rows; ++r) {
        if (!(visit.rows >> r & 1)) continue;
        for (int d = 0; d < D; ++d) {
          double* to = a[d] + s.row[static_cast<std::size_t>(r)] + j;
          const Pack sum = force[d][2 * r] + move_up(upper[r][d], force[d][2 * r + 1]);
          upper[r][d] = force[d][2 * r + 1];
          if (left >= lanes)
            store(to, load(to) + sum);
          else
            for (int l = 0; l < left; ++l) to[l] += sum[l];
          if (left <= lanes) to[left] += upper[r][d][static_cast<int>(left) - 1];
        }
      }
    }
  }
}

template <int D>
template <class Law>
void TlStressPoints<D>::sweep_part(const std::vector<Visit>& part, const Field& field, Law& law) const {
  const Columns<D> u(field);
  const double* per_mass = per_mass_.component(0);
  for (const Visit& visit : part) {
    for (int r = 0; r < rows; ++r)
      if (visit.rows >> r & 1)
        for (const auto& span : cells_.first_touched(visit.strip, r))
          for (int d = 0; d < D; ++d)
            std::fill(p_.a.component(d) + span.begin, p_.a.component(d) + span.end, 0.0);
    if (cells_.strips()[static_cast<std::size_t>(visit.strip)].regular)
      sweep_strip<BoxCells<D>>(visit, u, law);
    else
      sweep_strip<SkewCells<D>>(visit, u, law);
    for (int r = 0; r < rows; ++r)
      if (visit.rows >> r & 1)
        for (const auto& span : cells_.last_touched(visit.strip, r))
          for (int d = 0; d < D; ++d) {
            double* a = p_.a.component(d);
            for (Index i = span.begin; i < span.end; ++i) a[i] *= per_mass[i];
          }
  }
}

template <int D>
void TlStressPoints<D>::update_accelerations(double t) {
  share_out();
  ElasticLaw seen{*this};
  parallel_for(
      parts_.size(), parts_.size() > 1, seen,
      [&](std::size_t part, ElasticLaw& law) { sweep_part(parts_[part], p_.u, law); },
      [&](const ElasticLaw& law) {
        seen.extremes.merge(law.extremes);
        seen.inverted = std::min(seen.inverted, law.inverted);
      });
  this->stretch_ = seen.extremes.bounds();
  if (seen.inverted < p_.n) this->fail_inverted(seen.inverted);
  this->finish_accelerations(t);
}

template <int D>
double TlStressPoints<D>::strain_energy() const {
  this->need_energies();
  const auto strips = cells_.strips();
  std::vector<double> energy(strips.size(), 0.0);
  const Columns<D> u(p_.u);
  parallel_for(strips.size(), p_.n > parallel_from, [&](std::size_t k) {
    const Strip& s = strips[k];
    for (Index j = 0; j < s.count; j += lanes)
      energy[k] += with_cells(s, j, [&](const auto& cells) {
        Pack modes[D][cell_corners<D>], f[D * D];
        Bends<D> bends;
        load_modes<D>(s, j, u, modes);
        cells.deform(modes, f, bends);
        alignas(64) double F[D * D * lanes], H_diagonal[D * lanes], P[D * D * lanes], e[lanes];
        deform<D>(f, lanes, F, H_diagonal);
        materials_[s.material]->stress({lanes, lanes, F, P, e, H_diagonal});
        Pack bent = pack(0);
        for (int m = 0; m < bends.count; ++m)
          for (int d = 0; d < D; ++d)
            bent += relative_stiffness(hourglass_modes<D>[static_cast<std::size_t>(m)]) * bends.q[m][d] *
                    bends.q[m][d];
        const Pack all = share(s, j) *
                         (cells.volume() * load(e) + 0.5 * stiffness_[s.material] * cells.stiffness() * bent);
        double sum = 0;
        for (int l = 0; l < std::min<Index>(lanes, s.count - j); ++l) sum += all[l];
        return sum;
      });
  });
  double total = 0;
  for (const double e : energy) total += e;
  return total;
}

// Hourglass modes bend cells, and with unit control they have the energy that they should: only what the
// control adds to it or leaves out is rough.
template <int D>
MotionSample TlStressPoints<D>::motion() const {
  MotionSample sample;
  sample.known = true;
  const Columns<D> u(p_.u);
  double squares = 0, volume = 0;
  for (const Strip& s : cells_.strips()) {
    const double E = materials_[s.material]->parameters().E;
    for (Index j = 0; j < s.count; j += lanes)
      with_cells(s, j, [&](const auto& cells) {
        Pack modes[D][cell_corners<D>], H[D * D];
        Bends<D> bends;
        load_modes<D>(s, j, u, modes);
        cells.deform(modes, H, bends);
        Pack bent = pack(0), strain = pack(0);
        for (int m = 0; m < bends.count; ++m)
          for (int d = 0; d < D; ++d) bent += bends.q[m][d] * bends.q[m][d];
        for (int d = 0; d < D; ++d)
          for (int e = 0; e < D; ++e) {
            Pack G = H[d * D + e] + H[e * D + d];  // twice Green's strain
            for (int k = 0; k < D; ++k) G += H[k * D + d] * H[k * D + e];
            strain += 0.25 * G * G;
          }
        // Twice the energy under unit control over E is 1 / (3 D) sum |b_m|^2 / V q^2.
        const Pack rough = cells.stiffness() * bent / (3.0 * D), V = cells.volume();
        const Pack part = share(s, j);
        for (int l = 0; l < std::min<Index>(lanes, s.count - j); ++l) {
          sample.rough += std::abs(1 - control_) * E * part[l] * rough[l];
          sample.strain += E * part[l] * (V[l] * strain[l] + rough[l]);
          // Amplitude of a corner's motion over the edge of the cell.
          const double relative = std::sqrt(bent[l]) / cell_corners<D> / std::pow(V[l], 1.0 / D);
          squares += part[l] * V[l] * relative * relative;
          volume += part[l] * V[l];
          if (relative > sample.worst) {
            sample.worst = relative;
            sample.worst_at = s.row[0] + j + l;
          }
        }
      });
  }
  sample.mean = std::sqrt(squares / volume);
  return sample;
}

template <int D>
template <class Cells, class F>
void TlStressPoints<D>::with_stresses(const Strip& s, Index j, const Cells& cells, Index count, F&& f) const {
  Pack modes[D][cell_corners<D>], gradient[D * D];
  Bends<D> bends;
  load_modes<D>(s, j, Columns<D>(p_.u), modes);
  cells.deform(modes, gradient, bends);
  alignas(64) double block[D * D * lanes], H_diagonal[D * lanes], stress[D * D * lanes];
  deform<D>(gradient, lanes, block, H_diagonal);
  materials_[s.material]->stress({lanes, lanes, block, stress, nullptr, H_diagonal});
  for (int l = 0; l < count; ++l) {
    Mat<D> of_cell, P;
    for (int c = 0; c < D * D; ++c) {
      of_cell(c / D, c % D) = block[c * lanes + l];
      P(c / D, c % D) = stress[c * lanes + l];
    }
    f(l, of_cell, P);
  }
}

template <int D>
void TlStressPoints<D>::visit_stresses(const std::function<void(const StressSample<D>&)>& f) const {
  for (const Strip& s : cells_.strips())
    for (Index j = 0; j < s.count; j += lanes)
      with_cells(s, j, [&](const auto& cells) {
        with_stresses(s, j, cells, std::min<Index>(lanes, s.count - j),
                      [&](int l, const Mat<D>& F, const Mat<D>& P) {
                        std::array<Index, cell_corners<D>> corners;
                        Vec<D> centre = Vec<D>::Zero();
                        for (std::size_t c = 0; c < corners.size(); ++c) {
                          corners[c] = s.row[c / 2] + j + l + static_cast<Index>(c % 2);
                          centre += p_.X.template vec<D>(corners[c]) / cell_corners<D>;
                        }
                        f({centre, corners, s.material, F, P});
                      });
      });
}

// Mean of f(law, F, P) over the cells of a particle, with their volumes; over their images as well where the
// particle lies on symmetry planes.
template <int D>
template <int N, class F>
Mat<N> TlStressPoints<D>::mean(Index i, F&& f) const {
  Mat<N> sum = Mat<N>::Zero();
  double volume = 0;
  cells_.for_cells_of(i, [&](const Strip& s, Index j) {
    with_cells(s, j, [&](const auto& cells) {
      const double V = share(s, j)[0] * cells.volume()[0];
      with_stresses(s, j, cells, 1, [&](int, const Mat<D>& of_cell, const Mat<D>& P) {
        sum += V * f(*materials_[s.material], of_cell, P);
      });
      volume += V;
    });
  });
  if (!p_.planes.empty())
    for (int d = 0; d < D; ++d)
      for (int e = 0; e < D; ++e) {
        const unsigned planes = p_.planes[static_cast<std::size_t>(i)];
        if (d != e && ((planes >> d | planes >> e) & 1)) sum(d, e) = 0;  // images have it with the other sign
      }
  return sum / volume;
}

// Largest eigenvalue of M^-1 K of the body at rest, hourglass modes included.
template <int D>
double TlStressPoints<D>::stiffest_mode(const LawsAtRest& laws) {
  share_out();
  const auto apply = [&](const Field& y) {
#pragma omp parallel for schedule(static, 1) if (parts_.size() > 1)
    for (std::size_t part = 0; part < parts_.size(); ++part) {
      LawAtRest law{laws};
      sweep_part(parts_[part], y, law);
    }
    for (double& a : p_.a.flat()) a = -a;
  };
  Field mass(static_cast<std::size_t>(p_.n), 1);
  for (Index i = 0; i < p_.n; ++i) mass.component(0)[i] = 1 / per_mass_.component(0)[i];
  const double eigenvalue = largest_eigenvalue<D>(p_.n, p_.n, mass, p_.a, apply, &this->stiffest_);
  std::fill(p_.a.flat().begin(), p_.a.flat().end(), 0.0);
  return eigenvalue;
}

}  // namespace

FormulationEntry tl_stress_points_entry() {
  return {
      .name = "tl_stress_points",
      .line =
          "stress on the cells between the particles of a node-centred lattice, jittered or not; hourglass "
          "control that bends cells right",
      .fails = "on clouds without cells (files, cell-centred lattices)",
      .make = formulation_makers<TlStressPoints>(),
      .traits = {.stress = StressAt::cells,
                 .pairs = false,
                 .operators = false,
                 .cells = true,
                 .materials = MaterialsMeet::in_cells,
                 .zero_energy_control = 1},
      .parameters = {number_parameter("zero_energy_control", 1, Interval::non_negative(), "",
                                      "hourglass stiffness over the one that bends cells as a beam bends; "
                                      "0 = absent")}};
}

}  // namespace taut
