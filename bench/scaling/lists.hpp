#pragma once
/// \file
/// Pair lists of many points: taut's against those of nanoflann's own search.

#include <cstdint>
#include <string>
#include <string_view>
#include <taut/base/fields.hpp>
#include <taut/neighbors/search.hpp>
#include <vector>

namespace taut::bench {

/// Points in taut's order of locality, with one radius for all or one each.
struct ListCloud {
  std::string name;
  Field X;
  std::vector<double> radii;  ///< one for each point, or a single one

  PointView<3> view() const;
  std::size_t size() const { return X.particles(); }
  bool graded() const { return radii.size() > 1; }
  double radius(std::size_t i) const { return graded() ? radii[i] : radii[0]; }
};

/// A cube of points with about 32 neighbours each, `kind` one of `list_clouds()`: "lattice"; "jittered" by
/// 0.2 spacings; "graded", random points whose spacing, and radius with it, grows fourfold along x.
ListCloud list_cloud(std::string_view kind, std::int64_t points);
const std::vector<std::string>& list_clouds();

/// taut's list, radii included.
PairList taut_list(const ListCloud& cloud);

/// Neighbours of points in compressed rows, a piece a thread.
struct SearchedRows {
  struct Piece {
    std::size_t first = 0;            ///< point of the first row
    std::vector<std::size_t> row{0};  ///< neighbours of its point i: row[i] … row[i + 1]
    std::vector<Index> neighbour;
  };
  std::vector<Piece> pieces;
  std::size_t pairs() const;
};
/// nanoflann's k-d tree, built and asked for the points within each point's own radius (radiusSearch, not
/// sorted) in an OpenMP loop; a point is not its own neighbour.
SearchedRows nanoflann_lists(const ListCloud& cloud, int threads);

/// Pairs of taut's list that nanoflann's has as well: all, or where radii differ those within the radius of
/// the first particle.
std::size_t pairs_within_own_radius(const ListCloud& cloud, const PairList& list);

}  // namespace taut::bench
