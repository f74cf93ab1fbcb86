#pragma once
/// \file
/// What a material is to the rest of taut: deformation in, stress out, a block of particles at a time.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <taut/core/types.hpp>
#include <vector>

namespace taut {

/// How a 2D body treats the third direction. Ignored in 3D; 1D is always uniaxial strain.
enum class Plane { strain, stress };

/// Elastic constants of a material. SI units.
struct MaterialParameters {
  double E = 0;        ///< Young's modulus [Pa], > 0
  double nu = 0;       ///< Poisson's ratio, -1 < nu < 0.5
  double density = 0;  ///< reference density [kg/m^3], > 0
  Plane plane = Plane::strain;

  double mu() const { return E / (2 * (1 + nu)); }
  double lambda() const { return E * nu / ((1 + nu) * (1 - 2 * nu)); }
  double bulk() const { return E / (3 * (1 - 2 * nu)); }
};

/// Deformation gradients and first Piola–Kirchhoff stresses of `n` particles, structure of arrays: component (i, j),
/// row-major, of particle p stands at [(i * D + j) * stride + p]. `n` is a multiple of `lanes`; arrays may alias
/// (P == F).
template <int D>
struct StressBlock {
  int n = 0;
  std::size_t stride = 0;
  const double* F = nullptr;
  double* P = nullptr;
  double* energy = nullptr;  ///< stored energy per reference volume [J/m^3], one a particle; or null
};

/// Common part of all materials.
template <int D>
class Material {
 public:
  virtual ~Material() = default;
  virtual std::string_view name() const = 0;
  const MaterialParameters& parameters() const { return parameters_; }
  double density() const { return parameters_.density; }
  /// Pressure-wave speed of the undeformed body [m/s], for the time step; that of the plate in plane stress.
  double wave_speed() const;
  /// Upper bound of the wave speed, measured in reference lengths, where the principal stretches of the in-plane F lie
  /// in [stretch_min, stretch_max].
  virtual double wave_speed(double stretch_min, double stretch_max) const;

 protected:
  explicit Material(const MaterialParameters& parameters);  ///< \throws InputError for parameters out of range
  MaterialParameters parameters_;
};

/// Stress is a function of the deformation gradient.
template <int D>
class Hyperelastic : public Material<D> {
 public:
  using Material<D>::Material;
  /// P (and energy where asked for) of a block.
  virtual void stress(const StressBlock<D>& block) const = 0;
};

/// Number of stored components of a symmetric tensor: D = 1: xx; 2: xx, yy, xy; 3: xx, yy, zz, yz, xz, xy.
template <int D>
inline constexpr int sym_components = D == 1 ? 1 : D == 2 ? 3 : 6;

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

/// Stress follows from its rate: hypoelastic laws for the updated Lagrangian forms. The out-of-plane deviatoric component is
/// minus the sum of the in-plane ones.
template <int D>
class Hypoelastic : public Material<D> {
 public:
  using Material<D>::Material;
  virtual void rate(const RateBlock<D>& block) const = 0;
  virtual void stress(const RateBlock<D>& block) const = 0;
};

/// A material by its name. \throws InputError listing the valid names, or for parameters the model does not take.
template <int D>
std::unique_ptr<Material<D>> make_material(std::string_view name, const MaterialParameters& parameters);
std::vector<std::string> material_names();

}  // namespace taut
