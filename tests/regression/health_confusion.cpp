// What health flags, against how wrong answers are: every case whose truth is known under every method.
// Prints the table of bench/HEALTH.md; with TAUT_HEALTH=long in the environment, the long one (some minutes).
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string_view>

#include "bug_cases.hpp"

using namespace taut;
using namespace taut::bug_cases;

namespace {

struct Line {
  std::string subject, method;
  Answer answer;
};

bool is_long() {
  const char* set = std::getenv("TAUT_HEALTH");
  return set && std::string_view(set) == "long";
}
// Part of the table, for looking into it: only subjects that contain this.
bool wanted(const std::string& subject) {
  const char* only = std::getenv("TAUT_HEALTH_ONLY");
  return !only || subject.find(only) != std::string::npos;
}

void table(const std::function<void(const Line&)>& see) {
  const auto add = [&](const std::string& subject, const std::vector<Named>& methods,
                       const std::function<Answer(const Method&)>& run) {
    if (!wanted(subject)) return;
    for (const Named& m : methods) see({subject, m.name, run(m.method)});
  };
  const bool all = is_long();
  for (const int cells : all ? std::vector{1, 2, 4, 8} : std::vector{1, 2, 4})
    add(fmt::format("06 thin cantilever, {} cells", cells), on_nodes(),
        [&](const Method& m) { return thin(m, cells); });
  for (const int cells : all ? std::vector{2, 4, 8} : std::vector{2, 4})
    add(fmt::format("06 the same, cell-centred, {}", cells), on_pairs(),
        [&](const Method& m) { return thin(m, cells, Lattice::cell_centred); });
  for (const double dx : all ? std::vector{10.0, 5.0, 2.5} : std::vector{10.0, 5.0}) {
    add(fmt::format("17 tension, dx {:g} mm", dx), on_nodes(),
        [&](const Method& m) { return modulus(m, dx * 1e-3); });
    add(fmt::format("17 tension, dx {:g} mm", dx), in_rates(),
        [&](const Method& m) { return modulus(m, dx * 1e-3); });
  }
  add("17 tension, dx 5 mm, jitter 0.2", on_nodes(), [](const Method& m) { return modulus(m, 5e-3, 0.2); });
  for (const double turns : all ? std::vector{0.25, 1.0, 1.5} : std::vector{0.25}) {
    add(fmt::format("10 free spin, {:g} turns", turns), on_nodes(),
        [&](const Method& m) { return spin(m, turns); });
    add(fmt::format("10 free spin, {:g} turns", turns), in_rates(),
        [&](const Method& m) { return spin(m, turns); });
  }
  for (const double dx : all ? std::vector{20.0, 10.0, 5.0, 2.5} : std::vector{20.0, 10.0, 5.0})
    add(fmt::format("11 bars in series, dx {:g} mm", dx), on_nodes(),
        [&](const Method& m) { return series(m, dx * 1e-3); });
  for (const bool areas : {true, false})
    for (const int n : all ? std::vector{8, 16, 32} : std::vector{8})
      add(fmt::format("28 Cook, {} cells, areas {}", n, areas ? "given" : "guessed"), on_clouds(),
          [&](const Method& m) { return cook(m, n, areas); });
  add("37 centroids, 9 x 4", on_pairs(), [](const Method& m) { return centroids<2>(m, {9, 4}); });
  if (all)
    add("37 centroids, 10 x 3 x 3", on_pairs(), [](const Method& m) { return centroids<3>(m, {10, 3, 3}); });
  for (const double dx : all ? std::vector{4.0, 2.0, 1.0} : std::vector{4.0, 2.0})
    add(fmt::format("cantilever, dx {:g} mm", dx), on_nodes(),
        [&](const Method& m) { return cantilever(m, dx * 1e-3); });
  add("cantilever, dx 2 mm, jitter 0.15", on_nodes(),
      [](const Method& m) { return cantilever(m, 2e-3, 0.15); });
  for (const double dx : all ? std::vector{4.0, 2.0} : std::vector{4.0})
    add(fmt::format("nu 0.49, plane strain, dx {:g} mm", dx), on_nodes(),
        [&](const Method& m) { return locking(m, dx * 1e-3); });
  for (const double turns : all ? std::vector{0.7, 0.8} : std::vector<double>{})
    add(fmt::format("29 roll-up, {:g} turns", turns), on_nodes(),
        [&](const Method& m) { return roll_up(m, turns); });
  for (const double turns : {0.7, 0.8})
    add(fmt::format("29 roll-up, a fifth of {:g} turns", turns), on_nodes(),
        [&](const Method& m) { return roll_up(m, turns / 5, 0.2); });
  if (all)
    add("07 solid cantilever, 2 x 4 cells", on_nodes(), [](const Method& m) { return solid(m, 0.025); });
}

std::string error_of(const Answer& a) {
  if (!a.refused.empty()) return "refused";
  if (a.result.status == Status::broke) return "broke";
  return fmt::format("{:+.2f} %{}", 100 * a.error, a.finished ? "" : " (no rest)");
}

}  // namespace

TEST_CASE("health: what is far off is flagged, what is right is not") {
  std::array<std::array<int, 3>, 2> count{};
  fmt::print(
      "| case | method | error | roughness | spurious | faces | frequency | flagged "
      "|\n|---|---|---|---|---|---|---|---|\n");
  table([&](const Line& line) {
    const Answer& a = line.answer;
    const auto shown = [&](const char* name) {
      const HealthMeasure* m = a.result.health.find(name);
      return m ? fmt::format("{:.2g}", m->value) : std::string("–");
    };
    std::string flags =
        a.refused.empty() ? a.result.health.complaints() : "refused: " + a.refused.substr(0, 60);
    fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n", line.subject, line.method, error_of(a),
               shown("health_roughness"), shown("health_spurious_force"), shown("health_spurious_face_force"),
               shown("health_frequency"), flags);
    std::fflush(stdout);
    if (!a.finished) return;  // said anyway
    const double error = std::abs(a.error);
    ++count[a.suspect()][error < 0.01 ? 0 : error > 0.1 ? 2 : 1];
    CAPTURE(line.subject);
    CAPTURE(line.method);
    CAPTURE(a.error);
    CAPTURE(flags);
    if (error > 0.1) CHECK(a.suspect());
    if (error < 0.01) CHECK(!a.suspect());
  });
  fmt::print(
      "\n| | error < 1 % | 1 – 10 % | > 10 % |\n|---|---|---|---|\n| not flagged | {} | {} | {} |\n| flagged "
      "| {} | {} | {} |\n",
      count[0][0], count[0][1], count[0][2], count[1][0], count[1][1], count[1][2]);
}
