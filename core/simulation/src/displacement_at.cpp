#include <algorithm>
#include <array>
#include <cmath>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/base/small_solve.hpp>
#include <taut/geometry/local_origin.hpp>
#include <taut/particles/pair_rule.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

namespace {

constexpr double reach_dx = 3;

// Squared distances and ids, nearest first.
using Near = std::vector<std::pair<double, std::size_t>>;

// Displacement at X, at `at` in the cloud's coordinates, from the particles near it: the nearest first, until
// a plane through them is well determined.
template <int D>
Vec<D> fit(const Simulation<D>& simulation, const SimulationImpl<D>& s, const Vec<D>& X, const Vec<D>& at,
           Near& near) {
  const double dx = s.cloud.dx;
  if (near.empty()) throw InputError("displacement_at: no particle within three spacings of the point");
  const double same = std::max(1e-6 * dx, coordinate_rounding(X.norm()));
  if (near.front().first < same * same) return simulation.displacement(near.front().second);
  // Not across slits.
  if (const auto& rule = s.particles.rule)
    std::erase_if(near, [&, nearest = s.place(near.front().second)](const auto& other) {
      const Index i = s.place(other.second);
      return i != nearest && !rule->same_body(nearest, i);
    });
  Fixed<D + 1> normal = Fixed<D + 1>::Zero();
  Fixed<D + 1, D> right = Fixed<D + 1, D>::Zero();
  for (const auto& [r2, i] : near) {
    const double q2 = r2 / (9 * dx * dx);
    const double weight = (1 - q2) * (1 - q2) * (1 - q2) * (1 - q2) / (r2 / (dx * dx) + 0.05);
    Fixed<D + 1, 1> basis;
    basis << 1, (s.cloud.X[i] - at) / dx;
    normal += weight * basis * basis.transpose();
    right += weight * basis * simulation.displacement(i).transpose();
  }
  if (!solve_small(normal, right)) return simulation.displacement(near.front().second);
  return right.row(0).transpose();
}

// Takes in a particle that is near.
template <int D>
void consider(const Cloud<D>& cloud, std::size_t i, const Vec<D>& at, Near& near) {
  const double r2 = (cloud.X[i] - at).squaredNorm();
  if (r2 < 9 * cloud.dx * cloud.dx) near.emplace_back(r2, i);
}

// The particles in cells as wide as the reach, sorted by cell.
template <int D>
class Cells {
 public:
  explicit Cells(const Cloud<D>& cloud) : cloud_(cloud) {
    items_.reserve(cloud.size());
    for (std::size_t i = 0; i < cloud.size(); ++i) items_.push_back({cell_of(cloud.X[i]), i});
    std::sort(items_.begin(), items_.end());
  }

  Near near(const Vec<D>& at) const {
    Near found;
    const Cell middle = cell_of(at);
    int around = 1;
    for (int d = 0; d < D; ++d) around *= 3;
    for (int k = 0; k < around; ++k) {
      Cell cell = middle;
      for (std::size_t d = 0, rest = static_cast<std::size_t>(k); d < D; ++d, rest /= 3)
        cell[d] += static_cast<double>(rest % 3) - 1;
      for (auto it = std::lower_bound(items_.begin(), items_.end(), Item{cell, 0});
           it != items_.end() && it->cell == cell; ++it)
        consider(cloud_, it->id, at, found);
    }
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  using Cell = std::array<double, D>;  // whole numbers, of any size
  struct Item {
    Cell cell;
    std::size_t id;
    auto operator<=>(const Item&) const = default;
  };
  Cell cell_of(const Vec<D>& X) const {
    Cell cell;
    for (int d = 0; d < D; ++d) cell[static_cast<std::size_t>(d)] = std::floor(X[d] / (reach_dx * cloud_.dx));
    return cell;
  }

  const Cloud<D>& cloud_;
  std::vector<Item> items_;
};

}  // namespace

template <int D>
Vec<D> Simulation<D>::displacement_at(const Vec<D>& X) const {
  const SimulationImpl<D>& s = impl();
  const Vec<D> at = coordinate_difference<D>(X, s.cloud.origin);
  Near near;
  for (std::size_t i = 0; i < size(); ++i) consider(s.cloud, i, at, near);
  std::sort(near.begin(), near.end());
  return fit(*this, s, X, at, near);
}

template <int D>
std::vector<Vec<D>> Simulation<D>::displacements_at(std::span<const Vec<D>> X) const {
  const SimulationImpl<D>& s = impl();
  const Cells<D> cells(s.cloud);
  std::vector<Vec<D>> displacements(X.size());
  parallel_for(X.size(), worth_threads(static_cast<std::int64_t>(X.size())), [&](std::size_t k) {
    const Vec<D> at = coordinate_difference<D>(X[k], s.cloud.origin);
    Near near = cells.near(at);
    displacements[k] = fit(*this, s, X[k], at, near);
  });
  return displacements;
}

#define TAUT_INSTANTIATE(D)                                            \
  template Vec<D> Simulation<D>::displacement_at(const Vec<D>&) const; \
  template std::vector<Vec<D>> Simulation<D>::displacements_at(std::span<const Vec<D>>) const;
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
