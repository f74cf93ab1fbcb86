// Small matrices cross the border between a library and a program that are built with other flags: returned,
// stored, handed to functions of the user and received from them. A layout that followed the instruction set
// would crash here (by storing to an address that is not aligned as the other side expects) or change
// numbers.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <taut/formulations/formulation.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/taut.hpp>
#include <utility>
#include <vector>

namespace {

using namespace taut;

#define EXPECT(condition)                                         \
  do {                                                            \
    if (!(condition)) {                                           \
      std::printf("line %d: not so: %s\n", __LINE__, #condition); \
      ++failures;                                                 \
    }                                                             \
  } while (false)
int failures = 0;

const MaterialParameters rubber{.E = 2e6, .nu = 0.3, .density = 1000};

/// Returns a stress through a frame with `Size` bytes of something else.
template <int Size>
[[gnu::noinline]] Mat<2> through(const Simulation<2>& s, std::size_t id) {
  char before[Size];
  std::memset(before, 1, Size);
  const Mat<2> sigma = s.cauchy_stress(id);
  char after[Size];
  std::memcpy(after, before, Size);
  asm volatile("" : : "r"(before), "r"(after) : "memory");  // both are there
  return after[Size / 2] == 1 ? sigma : Mat<2>(Mat<2>::Zero());
}

/// Wherever the compiler puts it, it stands at a multiple of eight bytes and no better.
struct Odd {
  double first;
  Mat<2> sigma;
  Vec<2> u;
};

/// A law of the user's own: P = E (F - I).
class Springs final : public Hyperelastic<2> {
 public:
  explicit Springs(const MaterialParameters& parameters) : Hyperelastic<2>(parameters) {}
  std::string_view name() const override { return "springs"; }
  void stress(const StressBlock<2>& block) const override {
    for (int c = 0; c < 4; ++c)
      for (int p = 0; p < block.n; ++p) {
        const std::size_t at = static_cast<std::size_t>(c) * block.stride + static_cast<std::size_t>(p);
        block.P[at] = parameters_.E * (block.F[at] - (c == 0 || c == 3));
      }
  }
  double wave_speed(double, double, double, double) const override { return Material<2>::wave_speed(); }
};

/// A formulation of the user's own: particles that know nothing of each other.
class Dust final : public Formulation<2> {
 public:
  using Formulation<2>::Formulation;
  void update_accelerations(double t) override {
    for (double& a : p_.a.flat()) a = 0;
    finish_accelerations(t);
  }
  Fastest fastest() const override { return {.frequency = 1}; }
  Mat<2> cauchy_stress(Index i) const override { return Mat<2>::Constant(i + 1.0); }
  std::int64_t pairs() const override { return 0; }
  std::size_t bytes() const override { return sizeof(*this); }
};

void stresses_are_returned_and_stored() {
  Simulation<2> s(make_cloud(box<2>({0, 0}, {0.2, 0.05}), {.dx = 0.0125, .cells = true}),
                  make_material<2>("neo_hookean", rubber), {});
  s.set_displacement([](const Vec<2>& X) { return Vec<2>(0.1 * X[0], -0.02 * X[1]); });
  s.prepare();
  const double J = 1.1 * 0.98;
  const double exact = (rubber.mu() * (1.1 * 1.1 - 1) + rubber.lambda() * std::log(J)) / J;
  const double close = 1e-5 * exact;  // pair vectors are in single precision
  std::vector<Odd> stored;
  for (std::size_t i = 0; i < s.size(); ++i) {
    const Mat<2> sigma = s.cauchy_stress(i);
    EXPECT(std::abs(sigma(0, 0) - exact) < close);
    EXPECT(through<8>(s, i) == sigma);
    EXPECT(through<24>(s, i) == sigma);
    EXPECT(through<40>(s, i) == sigma);
    EXPECT(through<104>(s, i) == sigma);
    EXPECT((s.first_piola_kirchhoff(i) * s.deformation_gradient(i).transpose() / J - sigma).norm() < close);
    stored.push_back({1, sigma, s.displacement(i)});
    const Mat<3> whole = s.full_cauchy_stress(i);
    EXPECT((whole.topLeftCorner<2, 2>()) == sigma);
    EXPECT(std::abs(whole(2, 2) - rubber.lambda() * std::log(J) / J) < close);
  }
  const std::vector<Mat<2>> recovered = StressRecovery<2>(s).cauchy_stress();
  for (std::size_t i = 0; i < s.size(); ++i) EXPECT((recovered[i] - stored[i].sigma).norm() < close);
}

void a_material_of_the_user_is_asked() {
  Simulation<2> s(make_cloud(box<2>({0, 0}, {0.1, 0.1}), {.dx = 0.0125}), std::make_shared<Springs>(rubber),
                  {});
  s.set_displacement([](const Vec<2>& X) { return Vec<2>(0.1 * X[0], 0); });
  s.prepare();
  EXPECT(std::abs(s.cauchy_stress(7)(0, 0) / (0.1 * rubber.E) - 1) < 1e-5);
}

void a_formulation_of_the_user_is_run() {
  const std::size_t n = 11;
  Particles<2> particles;
  particles.n = particles.total = static_cast<Index>(n);
  particles.dx = 1;
  particles.X = particles.u = particles.v = particles.a = particles.m_flat = Field(n, 2);
  particles.V = particles.m = Field(n, 1);
  for (double& m : particles.m.flat()) m = 2;
  particles.material.resize(n);
  MaterialParameters sheet = rubber;
  sheet.plane = Plane::stress;
  particles.materials = {make_material<2>("neo_hookean", sheet)};
  const Constraints<2> constraints;
  Loads<2> loads;
  loads.add_body_force(particles.n, Vec<2>(3, -10));
  const Method method = with_defaults({});
  Dust dust({particles, constraints, loads, method});

  Formulation<2>& seen = dust;
  seen.update_accelerations(0);
  make_integrator("leapfrog")->step(seen, 0, 0.5);
  seen.inspect();
  EXPECT(!seen.failure());
  EXPECT(particles.a.vec<2>(n - 1) == Vec<2>(3, -10));
  const Mat<3> sigma = seen.full_cauchy_stress(4);  // the library's, which asks for the user's
  EXPECT(sigma(0, 1) == 5 && sigma(1, 1) == 5 && sigma(2, 2) == 0 && sigma(0, 2) == 0);
}

}  // namespace

int main() {
  stresses_are_returned_and_stored();
  a_material_of_the_user_is_asked();
  a_formulation_of_the_user_is_run();
  return failures == 0 ? 0 : 1;
}
