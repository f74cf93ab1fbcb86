#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <taut/geometry/visibility.hpp>

namespace taut {

namespace {

Index half_down(Index i) { return (i - (i & 1)) / 2; }

}  // namespace

template <int D>
Visibility<D>::Visibility(const std::array<Index, D>& size, std::vector<std::uint8_t> label, Index reach)
    : size_(size), label_(std::move(label)), uniform_(label_), reach_(reach) {
  Index stride = 1;
  std::vector<std::uint8_t> row;
  for (std::size_t d = 0; d < D; ++d) {
    const auto n = static_cast<std::size_t>(size[d]), r = static_cast<std::size_t>(reach);
    row.resize(n);
    for (std::size_t first = 0; first < uniform_.size(); ++first) {
      if (first / static_cast<std::size_t>(stride) % n != 0) continue;
      const auto at = [&](std::size_t i) -> std::uint8_t& {
        return uniform_[first + i * static_cast<std::size_t>(stride)];
      };
      for (std::size_t i = 0; i < n; ++i) row[i] = at(i);
      std::size_t alike = 0;  // cells up to this one that have its label
      for (std::size_t i = 0; i < n; ++i) {
        alike = i > 0 && row[i] == row[i - 1] ? alike + 1 : 1;
        if (i >= r) at(i - r) = alike > 2 * r ? row[i - r] : nothing;
      }
      for (std::size_t i = n - std::min(n, r); i < n; ++i) at(i) = nothing;
    }
    stride *= size[d];
  }
}

template <int D>
std::size_t Visibility<D>::number(const Cell& cell) const {
  std::size_t k = 0;
  for (std::size_t d = D; d-- > 0;)
    k = k * static_cast<std::size_t>(size_[d]) + static_cast<std::size_t>(cell[d]);
  return k;
}

template <int D>
bool Visibility<D>::has(Cell cell, std::uint8_t label) const {
  // Two planes across one axis may have to be gone through in turn.
  for (std::size_t turn = 0; turn < (planes_.size() > 1 ? 4 : 1); ++turn)
    for (const Plane& plane : planes_) {
      Index& c = cell[static_cast<std::size_t>(plane.axis)];
      const Index border = plane.at / 2;
      if (plane.side == 0 ? c < border : c >= border) c = plane.at - 1 - c;
    }
  for (std::size_t d = 0; d < D; ++d) {
    if (periodic_[d]) cell[d] = (cell[d] % size_[d] + size_[d]) % size_[d];
    if (cell[d] < 0 || cell[d] >= size_[d]) return false;
  }
  const std::uint8_t own = label_[number(cell)];
  return label == any ? own != nothing : own == label;
}

// Whether a says by itself that all around it, b included, is of the label.
template <int D>
bool Visibility<D>::is_uniform(const Site<D>& a, const Site<D>& b, std::uint8_t label) const {
  Cell cell;
  for (std::size_t d = 0; d < D; ++d) {
    cell[d] = half_down(a[d]);
    if (cell[d] < 0 || cell[d] >= size_[d] || std::abs(half_down(b[d]) - cell[d]) > reach_ - 1) return false;
  }
  const std::uint8_t of_all = uniform_[number(cell)];
  return of_all != nothing && (label == any || of_all == label);
}

template <int D>
bool Visibility<D>::connects(const Site<D>& a, const Site<D>& b, std::uint8_t label) const {
  if (is_uniform(a, b, label)) return true;
  // Where the way goes from cell to cell, in parts of it. Equal quotients are equal doubles.
  std::array<double, 256> times;
  std::size_t count = 0;
  times[count++] = 0;
  Site<D> way;
  for (std::size_t d = 0; d < D; ++d) {
    way[d] = b[d] - a[d];
    const Index low = std::min(a[d], b[d]), high = std::max(a[d], b[d]);
    for (Index c = 2 * half_down(low) + 2; c < high && count + 1 < times.size(); c += 2)
      times[count++] = static_cast<double>(c - a[d]) / way[d];
  }
  times[count++] = 1;
  std::sort(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t k = 1; k < count; ++k) {
    if (times[k] == times[k - 1]) continue;
    const double middle = 0.5 * (times[k - 1] + times[k]);
    Cell cell;
    unsigned between = 0;  // axes along which the way lies between two cells
    for (std::size_t d = 0; d < D; ++d) {
      if (way[d] == 0) {
        cell[d] = half_down(a[d]);
        if (a[d] % 2 == 0) between |= 1u << d;
      } else {
        cell[d] = static_cast<Index>(std::floor(0.5 * (a[d] + middle * way[d])));
      }
    }
    bool found = false;
    for (unsigned c = 0; c < 1u << D && !found; ++c) {
      if (c & ~between) continue;
      Cell beside = cell;
      for (std::size_t d = 0; d < D; ++d) beside[d] -= static_cast<Index>(c >> d & 1);
      found = has(beside, label);
    }
    if (!found) return false;
  }
  return true;
}

template class Visibility<1>;
template class Visibility<2>;
template class Visibility<3>;

}  // namespace taut
