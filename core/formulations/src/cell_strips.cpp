#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <taut/base/describe.hpp>
#include <taut/base/error.hpp>
#include <taut/formulations/cell_strips.hpp>

namespace taut {

template <int D>
CellStrips<D>::CellStrips(const Particles<D>& p)
    : cells_(static_cast<std::int64_t>(p.cells.size())), n_(p.n) {
  make_strips(p);
  find_regular(p);
  find_touches(p);
  for (std::size_t r = 0; r < rows; ++r) {
    by_row_[r].resize(strips_.size());
    std::iota(by_row_[r].begin(), by_row_[r].end(), Index{0});
    std::sort(by_row_[r].begin(), by_row_[r].end(), [&](Index a, Index b) {
      return strips_[static_cast<std::size_t>(a)].row[r] < strips_[static_cast<std::size_t>(b)].row[r];
    });
  }
}

template <int D>
void CellStrips<D>::make_strips(const Particles<D>& p) {
  std::vector<Index> order(p.cells.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::sort(order.begin(), order.end(), [&](Index a, Index b) {
    return p.cells[static_cast<std::size_t>(a)][0] < p.cells[static_cast<std::size_t>(b)][0];
  });
  if (!p.cell_share.empty()) shares_ = AlignedArray<double>(p.cells.size() + lanes);
  for (std::size_t q = 0; q < order.size(); ++q) {
    const auto& cell = p.cells[static_cast<std::size_t>(order[q])];
    if (!p.cell_share.empty()) shares_[q] = p.cell_share[static_cast<std::size_t>(order[q])];
    std::uint8_t material = std::numeric_limits<std::uint8_t>::max();
    for (std::size_t c = 0; c < cell.size(); ++c) {
      material = std::min(material, p.material[static_cast<std::size_t>(cell[c])]);
      if (c % 2 && cell[c] != cell[c - 1] + 1)
        throw InputError(fmt::format(
            "corners {} and {} of a cell do not follow each other: particles joined by cells must be listed "
            "in "
            "rows along x, as make_cloud does",
            p.id[static_cast<std::size_t>(cell[c - 1])], p.id[static_cast<std::size_t>(cell[c])]));
    }
    if (!p.cell_material.empty()) material = p.cell_material[static_cast<std::size_t>(order[q])];
    bool goes_on = !strips_.empty() && strips_.back().material == material;
    for (std::size_t r = 0; goes_on && r < rows; ++r)
      goes_on = cell[2 * r] == strips_.back().row[r] + strips_.back().count;
    if (!goes_on) {
      Strip s;
      for (std::size_t r = 0; r < rows; ++r) s.row[r] = cell[2 * r];
      s.cell = static_cast<Index>(q);
      s.material = material;
      strips_.push_back(s);
    }
    ++strips_.back().count;
  }
}

template <int D>
void CellStrips<D>::find_regular(const Particles<D>& p) {
  for (Strip& s : strips_) {
    const auto X = [&](std::size_t r, Index j) {
      return p.X.template vec<D>(static_cast<std::size_t>(s.row[r] + j));
    };
    const Vec<D> first = X(0, 0);
    s.spacing[0] = (X(0, s.count)[0] - first[0]) / s.count;
    for (int d = 1; d < D; ++d) s.spacing[d] = X(std::size_t{1} << (d - 1), 0)[d] - first[d];
    // Lattice coordinates are rounded.
    const double tolerance =
        32 * std::numeric_limits<double>::epsilon() *
        std::max(first.cwiseAbs().maxCoeff(), X(rows - 1, s.count).cwiseAbs().maxCoeff());
    s.regular = true;
    for (std::size_t r = 0; s.regular && r < rows; ++r)
      for (Index j = 0; j <= s.count && s.regular; ++j) {
        Vec<D> box = first;
        box[0] += j * s.spacing[0];
        for (int d = 1; d < D; ++d) box[d] += (r >> (d - 1) & 1) ? s.spacing[d] : 0.0;
        s.regular = (X(r, j) - box).cwiseAbs().maxCoeff() <= tolerance;
      }
  }
}

template <int D>
void CellStrips<D>::find_touches(const Particles<D>& p) {
  constexpr Index none = -1;
  std::vector<Index> first(static_cast<std::size_t>(n_), none), last(static_cast<std::size_t>(n_), none);
  const auto key = [](std::size_t k, std::size_t r) { return static_cast<Index>(k * rows + r); };
  for (std::size_t k = 0; k < strips_.size(); ++k)
    for (std::size_t r = 0; r < rows; ++r)
      for (Index i = strips_[k].row[r]; i <= strips_[k].row[r] + strips_[k].count; ++i) {
        Index& touch = first[static_cast<std::size_t>(i)];
        if (touch == none) touch = key(k, r);
        last[static_cast<std::size_t>(i)] = key(k, r);
      }
  for (std::size_t i = 0; i < first.size(); ++i)
    if (first[i] == none)
      throw InputError(fmt::format("particle {} at {} is a corner of no cell", p.id[i],
                                   describe<D>(p.reference_position(static_cast<Index>(i)))));
  const auto collect = [&](const std::vector<Index>& touch, std::vector<Span>& spans,
                           std::vector<Index>& begin) {
    begin.push_back(0);
    for (std::size_t k = 0; k < strips_.size(); ++k)
      for (std::size_t r = 0; r < rows; ++r) {
        const Index start = strips_[k].row[r], end = start + strips_[k].count + 1;
        for (Index i = start; i < end; ++i) {
          if (touch[static_cast<std::size_t>(i)] != key(k, r)) continue;
          if (static_cast<std::size_t>(begin.back()) < spans.size() && spans.back().end == i)
            ++spans.back().end;
          else
            spans.push_back({i, i + 1});
        }
        begin.push_back(static_cast<Index>(spans.size()));
      }
  };
  collect(first, first_, first_begin_);
  collect(last, last_, last_begin_);
}

template <int D>
std::vector<std::vector<typename CellStrips<D>::Visit>> CellStrips<D>::parts(int count) const {
  // Rows of a strip belong to one part as a whole: borders lie where none goes across.
  std::vector<Index> across(static_cast<std::size_t>(n_) + 2, 0);
  for (const Strip& s : strips_)
    for (const Index row : s.row) {
      ++across[static_cast<std::size_t>(row) + 1];
      --across[static_cast<std::size_t>(row + s.count) + 1];
    }
  std::vector<Index> borders = {0};
  Index crossing = 0;
  for (Index i = 0; i < n_; ++i) {
    crossing += across[static_cast<std::size_t>(i)];
    const auto wanted =
        static_cast<Index>(static_cast<std::int64_t>(n_) * static_cast<std::int64_t>(borders.size()) / count);
    if (crossing == 0 && i > borders.back() && i >= wanted) borders.push_back(i);
  }
  borders.push_back(n_);
  std::vector<std::vector<Visit>> parts(borders.size() - 1);
  for (std::size_t k = 0; k < strips_.size(); ++k)
    for (std::size_t part = 0; part < parts.size(); ++part) {
      std::uint8_t mask = 0;
      for (std::size_t r = 0; r < rows; ++r)
        if (strips_[k].row[r] >= borders[part] && strips_[k].row[r] < borders[part + 1])
          mask = static_cast<std::uint8_t>(mask | 1u << r);
      if (mask) parts[part].push_back({static_cast<Index>(k), mask});
    }
  return parts;
}

template <int D>
std::size_t CellStrips<D>::bytes() const {
  std::size_t indices = first_begin_.size() + last_begin_.size();
  for (const auto& order : by_row_) indices += order.size();
  return strips_.size() * sizeof(Strip) + shares_.bytes() + (first_.size() + last_.size()) * sizeof(Span) +
         indices * sizeof(Index);
}

template class CellStrips<1>;
template class CellStrips<2>;
template class CellStrips<3>;

}  // namespace taut
