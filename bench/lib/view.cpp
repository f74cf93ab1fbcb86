#include <algorithm>
#include <cmath>
#include <cstdint>
#include <lib/view.hpp>
#include <unordered_map>

namespace taut::bench {
namespace {

double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

Point cross(const Point& a, const Point& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Point normalized(const Point& a) {
  const double length = std::hypot(a[0], a[1], a[2]);
  return length > 0 ? Point{a[0] / length, a[1] / length, a[2] / length} : a;
}

/// Cell numbers of a place; those far away share the last one.
std::array<std::int64_t, 3> cell_of(const Point& x, const Point& origin, double edge) {
  std::array<std::int64_t, 3> cell{};
  for (std::size_t d = 0; d < 3; ++d)
    cell[d] = static_cast<std::int64_t>(std::clamp((x[d] - origin[d]) / edge, -1e6, 1e6) + 1e6 + 1);
  return cell;
}

std::uint64_t key_of(std::int64_t i, std::int64_t j, std::int64_t k) {
  return static_cast<std::uint64_t>(i) << 42 | static_cast<std::uint64_t>(j) << 21 |
         static_cast<std::uint64_t>(k);
}

}  // namespace

View::View(const Point& from) : towards_(normalized(from)) {
  const bool steep = std::hypot(towards_[0], towards_[1]) < 1e-6;
  right_ = normalized(cross(steep ? Point{0, 1, 0} : Point{0, 0, 1}, towards_));
  up_ = cross(towards_, right_);
}

Point View::project(const Point& x) const { return {dot(x, right_), dot(x, up_), dot(x, towards_)}; }

int View::axis_of(const Point& direction) {
  for (int d = 0; d < 3; ++d)
    if (direction[static_cast<std::size_t>(d)] > 1 - 1e-12) return d;
  return -1;
}

double View::brightness(const Point& normal) const {
  // From above the viewer's left shoulder.
  const Point n = normalized(normal);
  const double facing = 0.75 * dot(n, towards_) + 0.55 * dot(n, up_) - 0.35 * dot(n, right_);
  return 0.5 + 0.5 * std::clamp(facing, 0.0, 1.0);
}

std::vector<Point> outward(const std::vector<Point>& x, double spacing) {
  std::vector<Point> normals(x.size());
  if (x.empty() || !(spacing > 0)) return normals;
  const double reach = 2.1 * spacing;  // on a lattice, no place lies on its edge
  constexpr std::size_t most = 64;     // in a cell: eight where nothing clumps
  std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto c = cell_of(x[i], x[0], reach);
    std::vector<std::size_t>& cell = cells[key_of(c[0], c[1], c[2])];
    if (cell.size() < most) cell.push_back(i);
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto c = cell_of(x[i], x[0], reach);
    double count = 0;
    for (int k = 0; k < 27; ++k) {
      const auto found = cells.find(key_of(c[0] + k % 3 - 1, c[1] + k / 3 % 3 - 1, c[2] + k / 9 - 1));
      if (found == cells.end()) continue;
      for (const std::size_t j : found->second) {
        const Point away{x[i][0] - x[j][0], x[i][1] - x[j][1], x[i][2] - x[j][2]};
        if (dot(away, away) > reach * reach) continue;
        for (std::size_t d = 0; d < 3; ++d) normals[i][d] += away[d] / spacing;
        ++count;
      }
    }
    for (std::size_t d = 0; d < 3; ++d) normals[i][d] /= std::max(count, 1.0);
  }
  return normals;
}

}  // namespace taut::bench
