#pragma once
/// \file
/// What a material is to the rest of taut: deformation in, stress out, a block of particles at a time.

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <taut/base/parameters.hpp>
#include <taut/base/types.hpp>
#include <vector>

namespace taut {

/// How a 2D body treats the third direction. Ignored in 3D; 1D is always uniaxial strain.
enum class Plane { strain, stress };

/// Elastic constants of an isotropic material. SI units.
struct MaterialParameters {
  double E = 0;        ///< Young's modulus [Pa], > 0
  double nu = 0;       ///< Poisson's ratio, -1 < nu < 0.5
  double density = 0;  ///< reference density [kg/m^3], > 0
  Plane plane = Plane::strain;
  /// Of materials that have more than these: by the names of their entry (registry.hpp). What is not given
  /// has its default there.
  ParameterMap other{};

  double mu() const { return E / (2 * (1 + nu)); }                      ///< shear modulus [Pa]
  double lambda() const { return E * nu / ((1 + nu) * (1 - 2 * nu)); }  ///< first Lamé constant [Pa]
  double bulk() const { return E / (3 * (1 - 2 * nu)); }                ///< bulk modulus K [Pa]
};

/// Deformation gradients and first Piola–Kirchhoff stresses of `n` particles, structure of arrays: component
/// (i, j), row-major, of particle p stands at [(i * D + j) * stride + p]. `n` is a multiple of `lanes`;
/// arrays may alias (P == F).
template <int D>
struct StressBlock {
  int n = 0;
  std::size_t stride = 0;
  const double* F = nullptr;
  double* P = nullptr;
  double* energy = nullptr;  ///< stored energy per reference volume [J/m^3], one a particle; or null
  /// Diagonal of H = F - I, component i of particle p at [i * stride + p], to the digits that F itself has no
  /// room for where strains are small; or null.
  const double* H_diagonal = nullptr;
  /// Nominal stress P_kk [Pa] and stretch F_kk along the axes k = D … 2 that the body does not have,
  /// component k - D: P_kk of a stretch of 1 in 1D and plane strain, the stretch that leaves P_33 = 0 in
  /// plane stress. Both or neither; only for laws that `has_lateral_state()`.
  double* P_lateral = nullptr;
  double* F_lateral = nullptr;
};

/// Common part of all materials.
template <int D>
class Material {
 public:
  virtual ~Material() = default;
  virtual std::string_view name() const = 0;
  const MaterialParameters& parameters() const { return parameters_; }
  double density() const { return parameters_.density; }
  /// Pressure-wave speed of the undeformed body [m/s], for the time step: sqrt((lambda + 2 mu) / rho0), or
  /// that of the plate, sqrt(E / (rho0 (1 - nu²))), in plane stress.
  double wave_speed() const;
  /// Upper bound of the speed of plane waves [m/s], measured in reference lengths, over all states whose
  /// principal stretches (those of the in-plane F in 2D) lie in [stretch_min, stretch_max] and whose
  /// (in-plane) det F lies in [J_min, J_max]: the root of the largest eigenvalue, by magnitude, of the
  /// acoustic tensor A_ik = N_J N_L dP_iJ/dF_kL / rho0 over all directions N. Equals wave_speed() for the
  /// stretches 1, 1. The range of J only tightens it, and matters most for nearly incompressible materials at
  /// large stretch. Infinite for stretch_min <= 0 where the law has no bound there.
  virtual double wave_speed(double stretch_min, double stretch_max, double J_min = 0,
                            double J_max = std::numeric_limits<double>::infinity()) const = 0;

 protected:
  /// \throws InputError for parameters out of range.
  explicit Material(const MaterialParameters& parameters);
  MaterialParameters parameters_;
};

/// Stress is a function of the deformation gradient.
template <int D>
class Hyperelastic : public Material<D> {
 public:
  using Material<D>::Material;
  /// Whether the stress is the derivative of a stored energy. Ask before asking for energies.
  virtual bool has_energy() const { return true; }
  /// Whether `stress` fills P_lateral and F_lateral. A law that does not leaves the stresses along the axes
  /// that the body does not have unknown, but in plane stress, where they are zero.
  virtual bool has_lateral_state() const { return D == 3; }
  /// P (and energy and lateral state where asked for) of a block. A state outside the law's domain (det F <=
  /// 0 where the law has a logarithm or a rotation in it) gives NaN. \throws InputError if energy is asked
  /// for of a law that has none.
  virtual void stress(const StressBlock<D>& block) const = 0;
  /// The whole Cauchy stress at F [Pa], P F^T / J with all three stretches in J; for output. Where the
  /// lateral state is unknown, lateral stretches count as 1, and lateral stresses are NaN (zero in plane
  /// stress).
  virtual Mat<3> cauchy_stress(const Mat<D>& F) const;
};

/// Number of stored components of a symmetric tensor: D = 1: xx; 2: xx, yy, xy; 3: xx, yy, zz, yz, xz, xy.
template <int D>
inline constexpr int sym_components = D*(D + 1) / 2;

/// A block of a rate-form material. All arrays hold component c of particle p at [c * stride + p].
template <int D>
struct RateBlock {
  int n = 0;
  std::size_t stride = 0;
  const double* L = nullptr;    ///< velocity gradient, row-major, D×D [1/s]
  const double* s = nullptr;    ///< deviatoric Cauchy stress, in-plane symmetric components [Pa]
  const double* rho = nullptr;  ///< current (three-dimensional) density [kg/m^3]
  double* s_rate = nullptr;     ///< out of `rate`: ds/dt
  double* rho_rate = nullptr;   ///< out of `rate`: drho/dt by the trace of the three-dimensional strain rate
  double* sigma = nullptr;      ///< out of `stress`: Cauchy stress, symmetric components
};

/// Stress follows from its rate: hypoelastic laws for the updated Lagrangian forms. The out-of-plane
/// deviatoric component is minus the sum of the in-plane ones; in 1D each lateral one is -s_xx / 2.
///
/// In plane stress the density of this law is the three-dimensional one, while the sums of a 2D formulation
/// run over the density per area, rho_A, whose rate is -rho_A tr(L). The thickness over the reference one is
/// rho_A / rho; forces follow from sigma times that.
template <int D>
class Hypoelastic : public Material<D> {
 public:
  using Material<D>::Material;
  /// s_rate and rho_rate from L, s and rho.
  virtual void rate(const RateBlock<D>& block) const = 0;
  /// sigma from s and rho.
  virtual void stress(const RateBlock<D>& block) const = 0;
  /// The whole Cauchy stress [Pa] where the in-plane deviatoric stress is s and the density rho; for output.
  /// Lateral stresses are those of s minus the pressure s_xx - sigma_xx; zero in plane stress.
  virtual Mat<3> cauchy_stress(const Mat<D>& s, double rho) const;
};

/// A material of `material_registry()` (registry.hpp) by its name. In 1D all are in uniaxial strain. Plane
/// stress: S_33 = 0 for the St. Venant–Kirchhoff laws; P_33 = 0 solved to round-off for neo_hookean (NaN
/// where nu < 0 and a strong compression has no such state); a zero rate of sigma_33 for hypoelastic.
///
/// \throws InputError listing the valid names, or for parameters out of range.
template <int D>
std::shared_ptr<const Material<D>> make_material(std::string_view name, const MaterialParameters& parameters);
/// The names `make_material` knows.
std::vector<std::string> material_names();

}  // namespace taut
