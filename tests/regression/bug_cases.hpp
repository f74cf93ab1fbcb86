#pragma once
// Cases from public reports of people who use such codes, with truths: formulas, or quadratic finite
// elements. Their names and numbers are those of the collection that they come from.

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <string>
#include <taut/taut.hpp>
#include <vector>

namespace taut::bug_cases {

/// What one method made of one case.
struct Answer {
  double error = 0;      ///< relative, the worst of what the case measures; meaningless unless `finished`
  bool finished = true;  ///< neither broke nor failed to converge
  std::string refused;   ///< why set-up refused
  RunResult result;
  bool suspect() const { return !refused.empty() || !finished || result.suspect(); }
};

/// A method under the name that tables show.
struct Named {
  std::string name;
  Method method = with_defaults({});
};

inline Method total_lagrangian(const char* operators, const char* kernel, double support_dx = 1.5) {
  Method m = with_defaults({});
  m.operators = operators;
  m.kernel = kernel;
  m.support_dx = support_dx;
  return m;
}
inline Method of_form(const char* formulation) {
  Method m = with_defaults({});
  m.formulation = formulation;
  return m;
}
inline Method updated(const char* formulation, const char* velocity_gradient = "corrected") {
  Method m = with_defaults({});
  m.formulation = formulation;
  m.kernel = "sinc5";
  m.support_dx = 2.4;
  m.velocity_gradient = velocity_gradient;
  return m;
}
inline Method controlled(double control) {
  Method m = with_defaults({});
  m.zero_energy_control = control;
  return m;
}

inline const std::vector<Named>& on_pairs() {
  static const std::vector<Named> methods = {
      {"corrected", total_lagrangian("corrected", "wendland_c2")},
      {"corrected, quadratic kernel", total_lagrangian("corrected", "quadratic")},
      {"corrected, control 1", controlled(1)},
      {"compatible", total_lagrangian("compatible", "quadratic")},
      {"antisymmetric", total_lagrangian("antisymmetric", "quadratic")},
      {"bond", of_form("tl_bond_associated")}};
  return methods;
}
inline std::vector<Named> on_clouds() {
  std::vector<Named> methods = on_pairs();
  methods.push_back({"auto", {}});
  return methods;
}
inline std::vector<Named> on_nodes() {
  std::vector<Named> methods = on_pairs();
  methods.push_back({"stress points", of_form("tl_stress_points")});
  return methods;
}
inline const std::vector<Named>& in_rates() {
  static const std::vector<Named> methods = {{"ul_basic", updated("ul_basic")},
                                             {"ul_basic, standard", updated("ul_basic", "standard")},
                                             {"ul_artificial_stress", updated("ul_artificial_stress")}};
  return methods;
}
inline bool rates(const Method& m) { return m.formulation.starts_with("ul_"); }

template <int D>
std::shared_ptr<const Material<D>> law(const Method& m, const char* hyperelastic,
                                       MaterialParameters parameters) {
  return make_material<D>(rates(m) ? "hypoelastic" : hyperelastic, parameters);
}

/// Runs `solve(simulation)`, which gives the result and sets the error.
template <class Build, class Solve>
Answer answer(Build&& build, Solve&& solve) {
  Answer a;
  try {
    auto simulation = build();
    a.result = solve(simulation, a.error);
    a.finished = a.result.status == Status::ok;
  } catch (const InputError& error) {
    a.refused = error.what();
    a.finished = false;
  }
  return a;
}

/// 06: a cantilever strip 0.1 x 0.005 m, `cells` through its thickness, nu 0.49: tip 7.6739e-5 m (beam; FEM
/// within 0.03 %).
inline Answer thin(const Method& m, int cells, Lattice lattice = Lattice::node_centred) {
  constexpr double H = 0.005;
  const bool centred = lattice == Lattice::cell_centred;
  return answer(
      [&] {
        LatticeOptions o{.dx = H / cells, .lattice = lattice, .cells = !centred};
        if (centred) o.layers[0] = {3, 0};
        Simulation<2> s(
            make_cloud(box<2>({0, 0}, {0.1, H}), o),
            law<2>(m, "linear_elastic", {.E = 4.17e6, .nu = 0.49, .density = 1600, .plane = Plane::stress}),
            m);
        if (centred)
          s.clamp([](const Vec<2>& X) { return X[0] < 0; });
        else
          s.clamp(s.face("x_min"));
        s.load(s.face("x_max"), {0, 0.01});
        return s;
      },
      [](Simulation<2>& s, double& error) {
        const RunResult r = s.relax({.tolerance = 1e-5, .max_steps = 100000});
        error = s.displacement_at({0.1, H / 2}).y() / 7.6739e-5 - 1;
        return r;
      });
}

/// 17: a bar under a tension of 1 MPa at E 1 GPa: 2e-4 m.
inline Answer modulus(const Method& m, double dx, double jitter = 0) {
  return answer(
      [&] {
        Simulation<2> s(
            make_cloud(box<2>({0, 0}, {0.2, 0.05}), {.dx = dx, .jitter = jitter, .cells = true}),
            law<2>(m, "linear_elastic", {.E = 1e9, .nu = 0.3, .density = 1000, .plane = Plane::stress}), m);
        s.roller(s.face("x_min"), 0);
        s.roller(s.face("y_min"), 1);
        s.load(s.face("x_max"), {5e4, 0});
        return s;
      },
      [](Simulation<2>& s, double& error) {
        const RunResult r = s.relax({.max_steps = 30000});
        error = s.displacement_at({0.2, 0.025}).x() / 2e-4 - 1;
        return r;
      });
}

/// 10: a free square turning at 50 rad/s: angular momentum and kinetic energy stay (within 0.1 %).
inline Answer spin(const Method& m, double turns) {
  return answer(
      [&] {
        Simulation<2> s(make_cloud(box<2>({-.05, -.05}, {.05, .05}), {.dx = .005, .cells = true}),
                        law<2>(m, "linear_elastic", {.E = 1e7, .nu = .3, .density = 1000}), m);
        s.set_velocity([](const Vec<2>& X) { return Vec<2>(-50 * X.y(), 50 * X.x()); });
        return s;
      },
      [&](Simulation<2>& s, double& error) {
        const auto spin_of = [&] {
          double l = 0;
          for (std::size_t i = 0; i < s.size(); ++i) {
            const Vec<2> x = s.position(i), v = s.velocity(i);
            l += s.mass(i) * (x.x() * v.y() - x.y() * v.x());
          }
          return l;
        };
        s.prepare();
        const double L = spin_of(), K = s.kinetic_energy();
        const RunResult r = s.run(turns * 2 * std::numbers::pi / 50);
        error = std::max(std::abs(spin_of() / L - 1), std::abs(s.kinetic_energy() / K - 1));
        return r;
      });
}

/// 11: two bars in series, E 1 : 100: tip 1.01e-4 m under 1000 Pa.
inline Answer series(const Method& m, double dx) {
  return answer(
      [&] {
        const MaterialParameters soft{.E = 1e6, .nu = 0, .density = 1000, .plane = Plane::stress};
        MaterialParameters stiff = soft;
        stiff.E = 1e8;
        Simulation<2> s(make_cloud(box<2>({0, 0}, {0.2, 0.04}), {.dx = dx, .cells = true}),
                        law<2>(m, "linear_elastic", soft), m);
        s.set_material([](const Vec<2>& X) { return X.x() < 0.1 + 1e-9; },
                       law<2>(m, "linear_elastic", stiff));
        s.roller(s.face("x_min"), 0);
        s.roller(s.face("y_min"), 1);
        s.load(s.face("x_max"), {40, 0});
        return s;
      },
      [](Simulation<2>& s, double& error) {
        const RunResult r = s.relax({.tolerance = 1e-5, .max_steps = 100000});
        error = s.displacement_at({0.2, 0.02}).x() / 1.01e-4 - 1;
        return r;
      });
}

/// 29: a strip rolled up by its end over `turns`, its length and the time scaled with them: energy E I
/// theta^2 / (2 L).
inline Answer roll_up(const Method& m, double turns, double L = 1, int cells = 4) {
  const double H = .02, E = 1e7, T = 3 * L, end = 2 * std::numbers::pi * turns;
  return answer(
      [&] {
        Simulation<2> s(
            make_cloud(box<2>({0, -H / 2}, {L, H / 2}), {.dx = H / cells, .cells = true}),
            law<2>(m, "st_venant_kirchhoff", {.E = E, .nu = 0, .density = 1000, .plane = Plane::stress}), m);
        const auto centre = [=](double th) {
          return th < 1e-9 ? Vec<2>(L, 0) : Vec<2>(L * std::sin(th) / th, L * (1 - std::cos(th)) / th);
        };
        s.clamp(s.face("x_min"));
        for (int d = 0; d < 2; ++d)
          s.prescribe(s.face("x_max"), d, [=](const Vec<2>& X, double t) {
            const double q = std::min(1.0, t / T), th = end * q * q * (3 - 2 * q);
            const Vec<2> x = centre(th) + X.y() * Vec<2>(-std::sin(th), std::cos(th));
            return (x - X)[d];
          });
        return s;
      },
      [&](Simulation<2>& s, double& error) {
        RunResult r = s.run(T);
        if (r.status == Status::ok) r = s.relax({.tolerance = 1e-4, .max_steps = 60000});
        error = s.strain_energy() / (E * H * H * H / 12 * end * end / 2 / L) - 1;
        return r;
      });
}

/// The points of Cook's membrane: 28. With volumes of the quadrilaterals and, where wanted, area vectors.
inline Cloud<2> cook_cloud(int n, bool areas) {
  const auto N = static_cast<std::size_t>(n) + 1;
  Cloud<2> c;
  const auto at = [&](int i, int j) { return static_cast<std::size_t>(i) * N + static_cast<std::size_t>(j); };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const double u = double(i) / n, v = double(j) / n;
      c.X.emplace_back(48 * u, 44 * u + v * (44 - 28 * u));
    }
  c.V.assign(c.X.size(), 0);
  std::vector<Vec<2>> B(c.X.size(), Vec<2>::Zero());
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const std::array<std::size_t, 4> k = {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)};
      Vec<2> centre = Vec<2>::Zero();
      for (const auto q : k) centre += c.X[q] / 4;
      for (std::size_t q = 0; q < 4; ++q) {
        const std::array<Vec<2>, 4> part = {c.X[k[q]], (c.X[k[q]] + c.X[k[(q + 1) % 4]]) / 2, centre,
                                            (c.X[k[q]] + c.X[k[(q + 3) % 4]]) / 2};
        double twice = 0;
        for (std::size_t e = 0; e < 4; ++e) {
          const Vec<2>&a = part[e], &b = part[(e + 1) % 4];
          twice += a.x() * b.y() - a.y() * b.x();
        }
        c.V[k[q]] += std::abs(twice) / 2;
      }
    }
  const auto edge = [&](std::size_t a, std::size_t b) {
    const Vec<2> t = c.X[b] - c.X[a], area(t.y() / 2, -t.x() / 2);
    B[a] += area;
    B[b] += area;
  };
  for (int i = 0; i < n; ++i) {
    edge(at(i, 0), at(i + 1, 0));
    edge(at(n, i), at(n, i + 1));
    edge(at(i + 1, n), at(i, n));
    edge(at(0, i + 1), at(0, i));
  }
  if (areas) c.B = B;
  c.dx = 44.0 / n * 0.75;
  std::vector<double> nearest;
  for (std::size_t a = 0; a < c.X.size(); ++a) {
    double least = 1e300;
    for (std::size_t b = 0; b < c.X.size(); ++b)
      if (b != a) least = std::min(least, (c.X[a] - c.X[b]).norm());
    nearest.push_back(least);
  }
  std::nth_element(nearest.begin(), nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2),
                   nearest.end());
  c.dx = nearest[nearest.size() / 2];
  return c;
}
/// `auto` takes the cloud as a file brings it, and the support that it needs; other methods that of the
/// report.
inline Answer cook(Method m, int n, bool areas) {
  Cloud<2> cloud = cook_cloud(n, areas);
  if (m.formulation == "auto") {
    const auto file = std::filesystem::temp_directory_path() / fmt::format("taut_cook_{}_{}.csv", n, areas);
    {
      std::ofstream out(file);
      out.precision(17);
      out << (areas ? "x,y,volume,bx,by\n" : "x,y,volume\n");
      for (std::size_t i = 0; i < cloud.size(); ++i) {
        out << cloud.X[i].x() << ',' << cloud.X[i].y() << ',' << cloud.V[i];
        if (areas) out << ',' << cloud.B[i].x() << ',' << cloud.B[i].y();
        out << '\n';
      }
    }
    cloud = read_cloud<2>(file);
    std::filesystem::remove(file);
  } else {
    m.support_dx = 2.6;
  }
  return answer(
      [&] {
        Simulation<2> s(
            cloud, law<2>(m, "linear_elastic", {.E = 1, .nu = 1.0 / 3, .density = 1, .plane = Plane::stress}),
            m);
        s.clamp(s.face("x_min"));
        s.load(s.face("x_max"), {0, 1});
        return s;
      },
      [](Simulation<2>& s, double& error) {
        const RunResult r = s.relax({.tolerance = 1e-4, .max_steps = 30000});
        error = s.displacement_at({48, 52}).y() / 23.96 - 1;
        return r;
      });
}

/// 37: element centroids of a bar as a cloud with volumes, pulled by 1000 Pa at E 1 MPa: strain 1e-3 between
/// the first and the last column.
template <int D>
Answer centroids(const Method& m, std::array<int, D> cells) {
  Cloud<D> c;
  c.dx = 1;
  int all = 1;
  for (const int n : cells) all *= n;
  for (int k = 0; k < all; ++k) {
    Vec<D> X;
    for (int d = D - 1, rest = k; d >= 0; --d) {
      const int n = cells[static_cast<std::size_t>(d)];
      X[d] = rest % n + 0.5;
      rest /= n;
    }
    c.X.push_back(X);
    c.V.push_back(1);
  }
  return answer(
      [&] {
        Simulation<D> s(
            c, law<D>(m, "linear_elastic", {.E = 1e6, .nu = 0, .density = 1000, .plane = Plane::stress}), m);
        for (int d = 0; d < D; ++d)
          s.roller(s.face(std::array{"x_min", "y_min", "z_min"}[static_cast<std::size_t>(d)]), d);
        Vec<D> force = Vec<D>::Zero();
        force[0] = 1000.0 * all / cells[0];
        s.load(s.face("x_max"), force);
        return s;
      },
      [&](Simulation<D>& s, double& error) {
        const RunResult r = s.relax({.max_steps = 30000});
        Vec<D> at = Vec<D>::Constant(0.5);
        at[0] = cells[0] - 0.5;
        error = s.displacement_at(at).x() / (1e-3 * (cells[0] - 1)) - 1;
        return r;
      });
}

/// The cantilever of section 3.1 of Tran-Duc et al. (2023) at -250 N: tip -47.4404 mm (finite elements).
inline Answer cantilever(const Method& m, double dx, double jitter = 0) {
  return answer(
      [&] {
        Simulation<2> s(
            make_cloud(box<2>({0, 0}, {0.2, 0.02}), {.dx = dx, .jitter = jitter, .cells = true}),
            law<2>(m, "st_venant_kirchhoff", {.E = 20e6, .nu = 0, .density = 1000, .plane = Plane::stress}),
            m);
        s.clamp(s.face("x_min"));
        s.load(s.face("x_max"), {0, -250});
        return s;
      },
      [](Simulation<2>& s, double& error) {
        const RunResult r = s.relax({.tolerance = 1e-5, .max_steps = 60000});
        error = s.displacement_at({0.2, 0.01}).y() / -0.0474404 - 1;
        return r;
      });
}

/// The same in plane strain at nu 0.49: tip -36.60 mm (finite elements, their limit).
inline Answer locking(const Method& m, double dx) {
  return answer(
      [&] {
        Simulation<2> s(make_cloud(box<2>({0, 0}, {0.2, 0.02}), {.dx = dx, .cells = true}),
                        law<2>(m, "st_venant_kirchhoff",
                               {.E = 20e6, .nu = 0.49, .density = 1000, .plane = Plane::strain}),
                        m);
        s.clamp(s.face("x_min"));
        s.load(s.face("x_max"), {0, -250});
        return s;
      },
      [](Simulation<2>& s, double& error) {
        const RunResult r = s.relax({.tolerance = 1e-5, .max_steps = 100000});
        error = s.displacement_at({0.2, 0.01}).y() / -0.0366 - 1;
        return r;
      });
}

/// 07: a cantilever 1 x 0.1 x 0.05 m, nu 0.49, 12 kN on its end: tip -0.0662 m (finite elements).
inline Answer solid(const Method& m, double dx) {
  return answer(
      [&] {
        Simulation<3> s(make_cloud(box<3>({0, 0, 0}, {1, 0.1, 0.05}), {.dx = dx, .cells = true}),
                        law<3>(m, "linear_elastic", {.E = 1e9, .nu = 0.49, .density = 1000}), m);
        s.clamp(s.face("x_min"));
        s.load(s.face("x_max"), {0, -50, 0});
        return s;
      },
      [](Simulation<3>& s, double& error) {
        const RunResult r = s.relax({.tolerance = 1e-4, .max_steps = 60000});
        // Beam of Timoshenko, shear coefficient 5/6: F L^3 / (3 E I) + F L / (5/6 G A), both small against
        // the locking that is looked for.
        const double I = 0.05 * 0.001 / 12, G = 1e9 / 2.98;
        error = s.displacement_at({1, 0.05, 0.025}).y() / -(50 / (3e9 * I) + 50 / (5.0 / 6 * G * 0.005)) - 1;
        return r;
      });
}

}  // namespace taut::bug_cases
