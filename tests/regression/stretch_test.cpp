// A neo-Hookean bar drawn from 15 to 90 mm (thesis, University of Cape Town, sections 5.3.2 and 5.4.3):
// Cauchy stress of the particle in the middle against the exact one of the stretches imposed on the boundary,
// T = mu / J (l1^2 - 1) + lambda / J ln J (eq. 5.4-5.5 there).
//
// At nu = 0.49 the material itself gives way: the acoustic tensor of P = mu (F - F^-T) + lambda ln J F^-T has
// the eigenvalue mu + (mu + lambda (1 - ln J)) max(l1, l2)^2 / J^2, which turns negative at a volume ratio
// near 2.85. Along the bar, for l2 = 1, that is dP/dF = mu (1 + 1/F^2) + lambda (1 - ln F) / F^2 < 0 from F
// = 3.63 to 6.40, which is where the thesis saw an instability and blamed the time integration. In 2D the
// transverse direction goes first, at l1 = 2.83. No discretisation follows the uniform state beyond; the
// tests compare up to there, and ask that the rest completes.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <taut/taut.hpp>

using namespace taut;

namespace {

constexpr double L = 15e-3;
constexpr double wanted = 0.002;  // 1 % is asked for; 0.04 % was found

enum class Transverse { one, two, growing };  // l2 = 1, 2, or from 1 to 2 as l1 grows to 6

struct Draw {
  double nu = 0.3;
  double stretch = 6;
  double transits = 300;  // duration, in times of a pressure wave through the bar
  Transverse transverse = Transverse::one;
  int spacings = 30, rows = 5;
  double zero_energy_control = 0;
};

struct Drawn {
  Status status;
  double error;          // largest of the stress, over the exact one, from l1 = 1.02 on
  double first_failure;  // stretch where it first passes 1 %, or the last one
};

// Smooth from rest to rest (first and second derivatives zero), so that the bar hardly swings.
double smooth(double q) {
  q = std::clamp(q, 0.0, 1.0);
  return q * q * q * (10 + q * (6 * q - 15));
}

template <int D>
Drawn draw(const Draw& c) {
  const MaterialParameters m{.E = 200e9, .nu = c.nu, .density = 8000};
  const double T = c.transits * L / std::sqrt((m.lambda() + 2 * m.mu()) / m.density);
  const auto l1 = [=](double t) { return 1 + (c.stretch - 1) * smooth(t / T); };
  const auto l2 = [=](double t) {
    if (D == 1 || c.transverse == Transverse::one) return 1.0;
    return c.transverse == Transverse::two ? 2.0 : 1 + (l1(t) - 1) / 5;
  };
  const double dx = L / c.spacings, height = c.rows * dx;
  Vec<D> max = Vec<D>::Constant(height);
  max[0] = L;
  Simulation<D> s(make_cloud(box<D>(Vec<D>::Zero(), max), {.dx = dx}), make_material<D>("neo_hookean", m),
                  {.zero_energy_control = c.zero_energy_control});
  s.roller(s.face("x_min"), 0);
  s.prescribe(s.face("x_max"), 0, [=](const Vec<D>& X, double t) { return (l1(t) - 1) * X[0]; });
  if constexpr (D == 2) {
    s.roller(s.face("y_min"), 1);
    s.prescribe(s.face("y_max"), 1, [=](const Vec<D>& X, double t) { return (l2(t) - 1) * X[1]; });
    s.set_displacement([=](const Vec<D>& X) { return Vec<D>(0, (l2(0) - 1) * X[1]); });
  }
  Vec<D> middle = Vec<D>::Constant(c.rows / 2 * dx);
  middle[0] = c.spacings / 2 * dx;
  std::size_t centre = 0;
  for (std::size_t i = 1; i < s.size(); ++i)
    if ((s.reference_position(i) - middle).norm() < (s.reference_position(centre) - middle).norm())
      centre = i;

  Drawn drawn{Status::ok, 0, c.stretch};
  s.prepare();
  s.observe(T / 1000, [&](double t) {
    if (l1(t) < 1.02) return;  // a thousandth of the end's stress: what the first wave leaves is more
    const double J = l1(t) * l2(t), exact = m.mu() / J * (l1(t) * l1(t) - 1) + m.lambda() / J * std::log(J);
    const double error = std::abs(s.cauchy_stress(centre)(0, 0) / exact - 1);
    drawn.error = std::max(drawn.error, error);
    if (error > 0.01) drawn.first_failure = std::min(drawn.first_failure, l1(t));
  });
  drawn.status = s.run(T).status;
  CHECK(s.displacement_at(max)[0] == doctest::Approx((c.stretch - 1) * L));
  return drawn;
}

}  // namespace

TEST_CASE("stretch: the exact stress to six times the length, in one dimension") {
  for (const double control : {0.0, 0.1}) {
    CAPTURE(control);
    const auto drawn = draw<1>({.zero_energy_control = control});
    CHECK(drawn.status == Status::ok);
    CHECK(drawn.error < wanted);
  }
  // Ten times faster, the bar swings about it: more than a per cent, and less than five.
  const auto fast = draw<1>({.transits = 30});
  CHECK(fast.status == Status::ok);
  CHECK(fast.error > 0.01);
  CHECK(fast.error < 0.05);
}

TEST_CASE("stretch: the exact stress to six times the length, of a sheet of 31 x 6 particles") {
  for (const auto transverse : {Transverse::one, Transverse::two, Transverse::growing}) {
    CAPTURE(static_cast<int>(transverse));
    const auto drawn = draw<2>({.transverse = transverse});
    CHECK(drawn.status == Status::ok);
    CHECK(drawn.error < wanted);
  }
}

TEST_CASE("stretch: nu = 0.49 follows the exact stress to where the material gives way") {
  for (const auto& [transverse, stretch] : {std::pair{Transverse::one, 2.8}, std::pair{Transverse::two, 1.4},
                                            std::pair{Transverse::growing, 2.2}}) {
    CAPTURE(static_cast<int>(transverse));
    const auto drawn = draw<2>({.nu = 0.49, .stretch = stretch, .transverse = transverse});
    CHECK(drawn.status == Status::ok);
    CHECK(drawn.error < wanted);
  }
  // dP/dF vanishes at 3.63. At 3.6 the bar is 1.5 % off since the state is the displacement (0.03 % before,
  // and up to 3.58 now as then): it leaves the uniform state a little earlier.
  const auto bar = draw<1>({.nu = 0.49, .stretch = 3.58});
  CHECK(bar.status == Status::ok);
  CHECK(bar.error < wanted);
}

TEST_CASE("stretch: nu = 0.49 completes to six times the length") {
  const auto bar = draw<1>({.nu = 0.49});
  CHECK(bar.status == Status::ok);
  // It leaves the uniform state where that is unstable, as soon as round-off has grown.
  CHECK(bar.first_failure > 3.63);
  CHECK(bar.first_failure < 6.40);
  // A smaller sheet, drawn faster: it wrinkles into thin layers, whose steps are short.
  const auto sheet = draw<2>({.nu = 0.49, .transits = 30, .spacings = 12, .rows = 3});
  CHECK(sheet.status == Status::ok);
}
