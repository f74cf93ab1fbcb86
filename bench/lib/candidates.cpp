#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <lib/auto_rules.hpp>
#include <lib/candidates.hpp>
#include <lib/extrapolation.hpp>
#include <lib/names.hpp>
#include <lib/reference.hpp>
#include <lib/results.hpp>
#include <taut/formulations/auto_method.hpp>

namespace taut::bench {
namespace {

constexpr double aim = 0.8;            // of the tolerance
constexpr double highest_order = 2;    // of an operator that is linearly exact
constexpr double lowest_order = 0.25;  // below, refinement is hopeless

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

bool is_error(const ProbeSpec& probe) { return probe.measure == "curve_error"; }

bool same(const RunSpec& a, const RunSpec& b) {
  const Method &m = a.method, &n = b.method;
  const auto control = [](const Method& o) {
    return o.zero_energy_control.value_or(default_control(o.formulation));
  };
  return m.formulation == n.formulation && m.operators == n.operators && m.kernel == n.kernel &&
         m.support_dx == n.support_dx && control(m) == control(n) && m.pair_precision == n.pair_precision &&
         a.lattice.kind == b.lattice.kind && a.lattice.jitter == b.lattice.jitter && a.material.empty() &&
         b.material.empty();
}

std::string label_of(const Method& m) {
  if (!has_pairs(m.formulation)) return m.formulation;
  const std::string& what = has_operators(m.formulation) ? m.operators : m.formulation;
  return fmt::format("{}, {}, {:g} dx", what, m.kernel, m.support_dx);
}

/// Methods worth trying where the material gives stresses: what convergence studies found on lattices and on
/// jittered clouds, without those that no study found good at anything. The first is the choice of `auto`.
std::vector<Method> ladder(const AutoFacts& facts) {
  Method chosen;
  apply_auto_rules(facts, {}, chosen);
  std::vector<Method> methods = {chosen};
  if (facts.rate_law) return methods;
  for (const char* operators : {"corrected", "compatible", "antisymmetric"})
    for (const char* kernel : {"wendland_c2", "quadratic"}) {
      Method m = with_defaults({});
      m.operators = operators;
      m.kernel = kernel;
      methods.push_back(m);
    }
  return methods;
}

std::optional<double> value_of(const Sample& sample, const Quantity& quantity) {
  for (const CaseResult& c : sample.cases) {
    SweepPoint point = c.point;
    point.erase("dx");
    if (point != quantity.second) continue;
    for (const Measured& m : c.measured)
      if (m.probe == quantity.first) return m.value;
  }
  return {};
}

std::vector<Quantity> quantities_of(const Scene& scene, const RunSpec& run) {
  std::vector<Quantity> all;
  for (const SweepPoint& point : points_without_dx(scene))
    for (const ProbeSpec& probe : scene.probes)
      if (decides(probe) && wanted(probe, run, point)) all.emplace_back(&probe, point);
  return all;
}

std::optional<double> usable_reference(const Scene& scene, const RunSpec& run, const Quantity& q) {
  const auto reference = reference_value(scene, run, q.second, *q.first);
  return reference && *reference != 0 ? reference : std::nullopt;
}

std::string name_of(const Quantity& q) {
  return q.first->name + (q.second.empty() ? "" : " at " + describe(q.second));
}

/// Power law through the last two samples that have errors: at least two are needed.
double order_of(const Sample& coarse, const Sample& fine) {
  return order_between(coarse.dx, *coarse.error, fine.dx, *fine.error);
}

/// edge / n, the next at or below.
double snapped(double dx, double edge) { return edge / std::ceil(edge / dx * (1 - 1e-9)); }

/// Where errors should fall to the tolerance; nothing when they do not fall.
std::optional<Prediction> spacing_for(const std::vector<Sample>& s, double tolerance, double edge) {
  // The coarsest sample from which on all are good.
  std::size_t good = s.size();
  while (good > 0 && *s[good - 1].error <= tolerance && !s[good - 1].suspect()) --good;
  Prediction p;
  if (good == 0) return Prediction{s[0].dx, *s[0].error, 0, {}};
  const bool between = good < s.size();
  const std::size_t fine = between ? good : s.size() - 1;
  if (fine == 0) return {};
  p.order = order_of(s[fine - 1], s[fine]);
  if (!between && !(*p.order >= lowest_order)) return {};
  const double order = between ? *p.order : std::min(*p.order, highest_order);
  p.dx = snapped(s[fine].dx * std::pow(aim * tolerance / *s[fine].error, 1 / order), edge);
  if (between && p.dx <= s[fine].dx) return Prediction{s[fine].dx, *s[fine].error, 0, p.order};
  p.error = *s[fine].error * std::pow(p.dx / s[fine].dx, order);
  return p;
}

double seconds_at(const std::vector<Sample>& s, double dx, int dimension) {
  const Sample& fine = s.back();
  if (dx <= 0) return fine.seconds();
  double step_power = 1;
  if (s.size() > 1) {
    const Sample& coarse = s[s.size() - 2];  // steps grow as dx falls: an order below zero
    step_power = std::clamp(-order_between(coarse.dx, coarse.steps(), fine.dx, fine.steps()), 0.0, 2.0);
  }
  const double finer = fine.dx / dx;
  const double rate = fine.work() / fine.loop_s();
  return fine.work() * std::pow(finer, dimension + step_power) / rate +
         (fine.seconds() - fine.loop_s()) * std::pow(finer, dimension);
}

}  // namespace

bool Sample::suspect() const {
  return std::any_of(cases.begin(), cases.end(), [](const CaseResult& c) { return c.suspect(); });
}

double Sample::loop_s() const {
  double sum = 0;
  for (const CaseResult& c : cases) sum += c.loop_s;
  return sum;
}

double Sample::seconds() const {
  double sum = loop_s();
  for (const CaseResult& c : cases) sum += c.setup_s;
  return sum;
}

double Sample::work() const {
  double sum = 0;
  for (const CaseResult& c : cases) sum += static_cast<double>(c.steps) * static_cast<double>(c.pairs);
  return sum;
}

double Sample::steps() const {
  double sum = 0;
  for (const CaseResult& c : cases) sum += static_cast<double>(c.steps);
  return sum;
}

double Truths::spread() const {
  double most = 0;
  for (const auto& [quantity, truth] : of) most = std::max(most, truth.spread);
  return most;
}

bool decides(const ProbeSpec& probe) { return probe.only.runs.empty() && probe.only.formulations.empty(); }

std::vector<SweepPoint> points_without_dx(const Scene& scene) {
  std::vector<SweepPoint> points;
  for (SweepPoint point : scene.points()) {
    point.erase("dx");
    if (std::find(points.begin(), points.end(), point) == points.end()) points.push_back(point);
  }
  return points;
}

std::vector<Candidate> candidates_of(const Scene& scene, bool own_materials,
                                     std::vector<std::string>& left_out) {
  const std::vector<SweepPoint> points = points_without_dx(scene);
  std::vector<Candidate> all;
  for (const RunSpec& run : scene.runs) {
    Candidate candidate{run, {}, {}, {}, {}};
    candidate.run.only.erase("dx");
    const bool everywhere = std::all_of(
        points.begin(), points.end(), [&](const SweepPoint& point) { return wanted(candidate.run, point); });
    if (!everywhere)
      left_out.push_back(fmt::format("the run '{}' is not made at every swept point", run.label));
    else if (!own_materials && (!run.material.empty() || run.plane))
      left_out.push_back(
          fmt::format("the run '{}' has its own material, and no reference tells which is right", run.label));
    else
      all.push_back(std::move(candidate));
  }
  RunSpec base;
  base.lattice = scene.lattice;
  base.solve = scene.solve;
  base.place = scene.place;
  for (const Method& method : ladder(facts_of(scene, base))) {
    RunSpec run = base;
    run.method = method;
    run.label = label_of(method);
    if (std::none_of(all.begin(), all.end(), [&](const Candidate& c) { return same(c.run, run); }))
      all.push_back({run, {}, {}, {}, {}});
  }
  return all;
}

bool references_suffice(const Scene& scene, const RunSpec& run) {
  const std::vector<Quantity> all = quantities_of(scene, run);
  return std::all_of(all.begin(), all.end(), [&](const Quantity& q) {
    return is_error(*q.first) || usable_reference(scene, run, q);
  });
}

Truths truths_of(const Scene& scene, const std::vector<Candidate>& candidates) {
  Truths truths;
  for (const Quantity& q : quantities_of(scene, candidates.front().run)) {
    if (is_error(*q.first)) continue;
    if (const auto reference = usable_reference(scene, candidates.front().run, q)) {
      truths.of[q] = {*reference, 0, 0};
      continue;
    }
    std::vector<double> limits;
    std::string why = "no candidate has three spacings";
    for (const Candidate& c : candidates) {
      const std::size_t n = c.samples.size();
      if (!c.out.empty() || n < 3) continue;
      std::array<double, 3> h{}, f{};
      for (std::size_t k = 0; k < 3; ++k) {
        h[k] = c.samples[n - 3 + k].dx;
        f[k] = value_of(c.samples[n - 3 + k], q).value_or(std::nan(""));
      }
      const Extrapolated e = richardson(h, f);
      if (e.ok)
        limits.push_back(e.limit);
      else
        why = e.why_not;
    }
    if (limits.empty() || median(limits) == 0) {
      truths.untold.push_back(fmt::format("{}: {}", name_of(q), limits.empty() ? why : "its limit is zero"));
      continue;
    }
    Truth truth{median(limits), static_cast<int>(limits.size()), 0};
    for (double& limit : limits) limit = std::abs(limit / truth.value - 1);
    truth.spread = median(limits);
    truths.of[q] = truth;
  }
  return truths;
}

void judge(Candidate& candidate, const Truths& truths) {
  for (Sample& sample : candidate.samples) {
    sample.error.reset();
    for (const CaseResult& c : sample.cases) {
      SweepPoint point = c.point;
      point.erase("dx");
      for (const Measured& m : c.measured) {
        if (!m.value || !decides(*m.probe)) continue;
        const auto truth = truths.of.find({m.probe, point});
        if (!is_error(*m.probe) && truth == truths.of.end()) continue;
        const double error = is_error(*m.probe) ? *m.value : error_of(*m.value, truth->second.value, false);
        sample.error = std::max(sample.error.value_or(0), std::abs(error));
      }
    }
  }
}

void predict(Candidate& candidate, double tolerance, double edge, double finest, int dimension) {
  candidate.prediction.reset();
  if (!candidate.out.empty()) return;
  const std::vector<Sample>& s = candidate.samples;
  if (s.empty() || std::any_of(s.begin(), s.end(), [](const Sample& x) { return !x.error; })) {
    candidate.out = "no truth to judge it by";
    return;
  }
  // Pilots may be too coarse to be trusted; the last one tells what refinement leads to.
  if (s.back().suspect()) {
    const auto of = std::find_if(s.back().cases.begin(), s.back().cases.end(),
                                 [](const CaseResult& c) { return c.suspect(); });
    candidate.out = fmt::format("suspect{}: {}",
                                s.back().dx > 0 ? fmt::format(" at dx {:.3g} mm", s.back().dx * 1e3) : "",
                                of->health.complaints());
    return;
  }
  std::optional<Prediction> p;
  if (edge > 0)
    p = spacing_for(s, tolerance, edge);
  else if (*s[0].error <= tolerance)
    p = Prediction{0, *s[0].error, 0, {}};
  if (!p) {
    candidate.out = edge > 0 ? fmt::format("does not converge: order {:.2f} at {:.3g} %",
                                           order_of(s[s.size() - 2], s.back()), 100 * *s.back().error)
                             : fmt::format("error {:.3g} %", 100 * *s[0].error);
    return;
  }
  if (p->dx < finest * (1 - 1e-9)) {
    candidate.out = fmt::format("would need dx {:.3g} mm, finer than an eighth of the scene's", p->dx * 1e3);
    return;
  }
  p->seconds = seconds_at(s, p->dx, dimension);
  candidate.prediction = p;
}

Candidate* cheapest(std::vector<Candidate>& candidates) {
  Candidate* best = nullptr;
  for (Candidate& c : candidates)
    if (c.out.empty() && c.prediction && (!best || c.prediction->seconds < best->prediction->seconds))
      best = &c;
  return best;
}

}  // namespace taut::bench
