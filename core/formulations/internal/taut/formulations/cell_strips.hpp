#pragma once
/// \file
/// Cells in strips along the first axis, whose corners are contiguous in memory.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <taut/base/types.hpp>
#include <taut/particles/particles.hpp>
#include <vector>

namespace taut {

/// All cells of a body, in strips: cell j of a strip has corners `row[r] + j` and `row[r] + j + 1` in each of
/// its 2^(D-1) rows of particles, bit d - 1 of r telling which side of axis d. Keeps which strip is the first
/// and which the last to touch a particle, so that one sweep over the strips can clear, sum and finish the
/// particles while they are in cache, and how to share the strips among threads: a particle belongs to one
/// part, which visits all strips that touch it, in their order. Sums are the same to the last bit for any
/// number of parts.
template <int D>
class CellStrips {
 public:
  static constexpr int rows = 1 << (D - 1);

  struct Strip {
    std::array<Index, rows> row{};
    Index count = 0;            ///< of cells
    Index cell = 0;             ///< number of its first cell: where its shares stand
    std::uint8_t material = 0;  ///< the cells' own, or the first one among those of the corners
    bool regular = false;       ///< all cells are equal boxes along the axes
    Vec<D> spacing;             ///< edges of a regular one [m]
  };
  struct Span {
    Index begin, end;  ///< particles
  };
  /// A strip as one part sees it.
  struct Visit {
    Index strip;
    std::uint8_t rows;  ///< bit r: row r belongs to the part
  };

  CellStrips() = default;
  /// Strips of all cells of `p`, in the order of their first corners. \throws InputError for corners that do
  /// not follow each other along the first axis, or a particle without a cell.
  explicit CellStrips(const Particles<D>& p);

  std::span<const Strip> strips() const { return strips_; }
  std::int64_t cells() const { return cells_; }
  /// Particles of row r that no strip before this one touches.
  std::span<const Span> first_touched(Index strip, int r) const {
    return spans(first_, first_begin_, strip, r);
  }
  /// Particles of row r that no strip behind this one touches.
  std::span<const Span> last_touched(Index strip, int r) const { return spans(last_, last_begin_, strip, r); }
  /// Part of each cell that is body, or null where all are whole.
  const double* shares(const Strip& s) const { return shares_.empty() ? nullptr : shares_.data() + s.cell; }

  /// The visits of each of about `count` parts of alike size; fewer where rows are few.
  std::vector<std::vector<Visit>> parts(int count) const;

  /// Calls f(strip, j) for each cell j that particle i is a corner of.
  template <class F>
  void for_cells_of(Index i, F&& f) const;

  std::size_t bytes() const;

 private:
  static std::span<const Span> spans(const std::vector<Span>& all, const std::vector<Index>& begin,
                                     Index strip, int r) {
    const auto k = static_cast<std::size_t>(strip) * rows + static_cast<std::size_t>(r);
    return {all.data() + begin[k], all.data() + begin[k + 1]};
  }
  void make_strips(const Particles<D>& p);
  void find_regular(const Particles<D>& p);
  void find_touches(const Particles<D>& p);

  std::vector<Strip> strips_;
  AlignedArray<double> shares_;  // a pack longer than the cells
  std::vector<Span> first_, last_;
  std::vector<Index> first_begin_, last_begin_;
  std::array<std::vector<Index>, rows> by_row_;  // strips by the first particle of their row r
  std::int64_t cells_ = 0;
  Index n_ = 0;
};

template <int D>
template <class F>
void CellStrips<D>::for_cells_of(Index i, F&& f) const {
  for (std::size_t r = 0; r < rows; ++r) {
    const std::vector<Index>& order = by_row_[r];
    const auto start = [&](Index k) { return strips_[static_cast<std::size_t>(k)].row[r]; };
    auto at = std::upper_bound(order.begin(), order.end(), i, [&](Index p, Index k) { return p < start(k); });
    // In one row of corners strips overlap by no more than their ends.
    for (int back = 0; back < 2 && at != order.begin(); ++back) {
      const Strip& s = strips_[static_cast<std::size_t>(*--at)];
      const Index j = i - s.row[r];
      if (j > 0 && j <= s.count) f(s, j - 1);
      if (j < s.count) f(s, j);
    }
  }
}

}  // namespace taut
