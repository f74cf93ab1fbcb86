#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <taut/base/error.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/kernels/registry.hpp>

namespace taut {
namespace {

using std::numbers::pi;

// Shapes and their derivatives, all functions of q = r/h within [0, kappa).

double lucy(double q) { return (1 + 3 * q) * (1 - q) * (1 - q) * (1 - q); }
double lucy_slope(double q) { return -12 * q * (1 - q) * (1 - q); }

double cubic_spline(double q) {
  const double far = 2 - q;
  return q < 1 ? 1 - q * q * (1.5 - 0.75 * q) : 0.25 * far * far * far;
}
double cubic_spline_slope(double q) {
  const double far = 2 - q;
  return q < 1 ? -q * (3 - 2.25 * q) : -0.75 * far * far;
}

double gaussian(double q) { return std::exp(-q * q); }
double gaussian_slope(double q) { return -2 * q * std::exp(-q * q); }

double mollifier(double q) { return std::exp(-1 / ((1 - q) * (1 + q))); }
double mollifier_slope(double q) {
  const double u = (1 - q) * (1 + q);
  return -2 * q / (u * u) * std::exp(-1 / u);
}

double modified_mollifier(double q) {
  const double u = (1 - q) * (1 + q), u2 = u * u, u4 = u2 * u2;
  return std::exp(-1 / u) * u4 * u4;
}
double modified_mollifier_slope(double q) {
  const double u = (1 - q) * (1 + q), u2 = u * u;
  return -2 * q * std::exp(-1 / u) * u2 * u2 * u2 * (1 + 8 * u);
}

double quadratic(double q) { return 0.75 * (1 - q / 2) * (1 - q / 2); }
double quadratic_slope(double q) { return -0.75 * (1 - q / 2); }

double wendland_c2(double q) {
  const double u = 1 - q / 2, u2 = u * u;
  return u2 * u2 * (2 * q + 1);
}
double wendland_c2_slope(double q) {
  const double u = 1 - q / 2;
  return -5 * q * u * u * u;
}

double sinc(double z) { return std::abs(z) < 1e-4 ? 1 - z * z / 6 : std::sin(z) / z; }
double sinc_slope(double z) {
  // Near zero z cos z - sin z cancels: its series instead, exact to round-off below 1/4.
  if (z < 0.25) {
    const double s = z * z;
    return -z / 3 * (1 - s / 10 * (1 - s / 28 * (1 - s / 54 * (1 - s / 88 * (1 - s / 130)))));
  }
  return (z * std::cos(z) - std::sin(z)) / (z * z);
}
double sinc5(double q) {
  const double f = sinc(pi / 2 * q), f2 = f * f;
  return f2 * f2 * f;
}
double sinc5_slope(double q) {
  const double z = pi / 2 * q, f = sinc(z), f2 = f * f;
  return 5 * pi / 2 * f2 * f2 * sinc_slope(z);
}

std::vector<KernelEntry> own_kernels() {
  return {
      {"lucy",
       "one cubic over the support (Lucy 1977)",
       1,
       lucy,
       lucy_slope,
       false,
       {5.0 / 4, 5 / pi, 105 / (16 * pi)}},
      {"cubic_spline",
       "piecewise cubic (Monaghan and Lattanzio 1985)",
       2,
       cubic_spline,
       cubic_spline_slope,
       false,
       {2.0 / 3, 10 / (7 * pi), 1 / pi}},
      {"gaussian",
       "cut off at 3 h, where it still has 1.2e-4 of its centre value (Gingold and Monaghan 1977)", 3,
       gaussian, gaussian_slope, true},
      {"mollifier", "exp(-1 / (1 - q^2)): all derivatives vanish at the edge", 1, mollifier, mollifier_slope},
      {"modified_mollifier", "the mollifier times (1 - q^2)^8, which comes close to a Gaussian", 1,
       modified_mollifier, modified_mollifier_slope},
      {"quadratic",
       "a parabola, with a kink at the centre (Johnson, Stryk and Beissel 1996)",
       2,
       quadratic,
       quadratic_slope,
       false,
       {1, 2 / pi, 5 / (4 * pi)}},
      {"wendland_c2",
       "positive definite, twice differentiable (Wendland 1995)",
       2,
       wendland_c2,
       wendland_c2_slope,
       false,
       {3.0 / 4, 7 / (4 * pi), 21 / (16 * pi)}},
      {"sinc5", "the fifth power of a sinc (Cabezon, Garcia-Senz and Relano 2008)", 2, sinc5, sinc5_slope},
  };
}

// Integral of f over [0, length] by the tanh-sinh rule (Takahasi and Mori 1974): round-off is reached for the
// smooth shapes that come here, whatever their behaviour at the ends.
template <class F>
double integrate(double length, F&& f) {
  constexpr double step = 1.0 / 32, reach = 3.2;
  double sum = 0;
  for (int i = static_cast<int>(-reach / step); i * step <= reach; ++i) {
    const double t = i * step, s = pi / 2 * std::sinh(t);
    const double c = std::cosh(s);
    sum += f(length / (1 + std::exp(-2 * s))) * pi / 4 * std::cosh(t) / (c * c);
  }
  return sum * step * length;
}

// The constants that are not given.
void normalise(KernelEntry& entry) {
  constexpr std::array<double, 3> sphere{2, 2 * pi, 4 * pi};
  for (std::size_t d = 0; d < 3; ++d) {
    double& constant = entry.constants[d];
    const auto shell = [&](double q) {
      return q < entry.radius_factor ? entry.shape(q) * std::pow(q, d) : 0.0;
    };
    if (!(constant > 0)) constant = 1 / (sphere[d] * integrate(entry.radius_factor, shell));
    if (!(constant > 0) || !std::isfinite(constant))
      throw InputError(fmt::format("kernel \"{}\": its shape has no positive integral", entry.name));
  }
}

Registry<KernelEntry>& registry() {
  static Registry<KernelEntry> all = [] {
    std::vector<KernelEntry> own = own_kernels();
    for (KernelEntry& entry : own) normalise(entry);
    return Registry<KernelEntry>("kernel", std::move(own));
  }();
  return all;
}

double power(double h, int n) { return n == 1 ? h : n == 2 ? h * h : n == 3 ? h * h * h : (h * h) * (h * h); }

}  // namespace

const Registry<KernelEntry>& kernel_registry() { return registry(); }

void add_kernel(KernelEntry entry) {
  if (!entry.shape || !entry.slope || !(entry.radius_factor > 0) || !std::isfinite(entry.radius_factor))
    throw InputError(
        fmt::format("kernel \"{}\" needs a shape, its slope and a positive radius_factor", entry.name));
  normalise(entry);
  registry().add(std::move(entry));
}

Kernel::Kernel(std::string_view name, int dimension) : dimension_(dimension) {
  if (dimension < 1 || dimension > 3)
    throw InputError(fmt::format("kernel {}: dimension {} is not 1, 2 or 3", name, dimension));
  entry_ = &registry().find(name);
  constant_ = entry_->constants[static_cast<std::size_t>(dimension - 1)];
}

std::string_view Kernel::name() const { return entry_->name; }

double Kernel::radius_factor() const { return entry_->radius_factor; }

double Kernel::value(double r, double h) const {
  const double q = r / h;
  return q >= entry_->radius_factor ? 0 : constant_ * entry_->shape(q) / power(h, dimension_);
}

double Kernel::derivative(double r, double h) const {
  const double q = r / h;
  return q >= entry_->radius_factor ? 0 : constant_ * entry_->slope(q) / power(h, dimension_ + 1);
}

std::vector<std::string> Kernel::names() { return registry().names(); }

}  // namespace taut
