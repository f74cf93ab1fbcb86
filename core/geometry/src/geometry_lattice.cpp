#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <taut/base/error.hpp>
#include <taut/base/powers.hpp>
#include <taut/geometry/geometry.hpp>
#include <taut/geometry/local_origin.hpp>
#include <taut/geometry/occupancy.hpp>
#include <taut/geometry/shape_volume.hpp>

namespace taut {
namespace {

constexpr const char* axis_names[] = {"x", "y", "z"};
constexpr int max_samples = 16;

// Sample points of a cell that are inside; up to max_samples^3.
using Fill = std::uint16_t;

template <int D>
using Place = std::array<std::int64_t, D>;

constexpr std::int64_t power(std::int64_t base, int exponent) {
  return exponent == 0 ? 1 : base * power(base, exponent - 1);
}

void check(const LatticeOptions& o, int dimension) {
  if (!(o.dx > 0) || !std::isfinite(o.dx))
    throw InputError(fmt::format("make_cloud: spacing {} is not positive and finite", o.dx));
  if (!(o.jitter >= 0 && o.jitter <= 0.4))
    throw InputError(fmt::format("make_cloud: jitter {} is not within 0 … 0.4", o.jitter));
  if (o.samples < 1 || o.samples > max_samples)
    throw InputError(fmt::format("make_cloud: samples {} is not within 1 … {}", o.samples, max_samples));
  for (int d = 0; d < 3; ++d)
    for (const int layers : o.layers[static_cast<std::size_t>(d)]) {
      if (layers < 0)
        throw InputError(fmt::format("make_cloud: {} layers along {} are negative", layers, axis_names[d]));
      if (layers > 0 && d >= dimension)
        throw InputError(fmt::format("make_cloud: layers along {} in {}D", axis_names[d], dimension));
    }
}

// The length of an edge: the multiple of dx that the coordinates of its ends leave possible, if there is one.
double edge_length(double min, double max, double dx) {
  const double length = max - min, multiple = std::round(length / dx) * dx;
  const double rounding = coordinate_rounding(min) + coordinate_rounding(max);
  return multiple > 0 && std::abs(multiple - length) <= rounding ? multiple : coordinate_difference(max, min);
}

// The lattice: `cells` across the body's box, `layers` before and behind them, and one empty cell around all
// so that the stencils below need no bounds.
template <int D>
struct Grid {
  Place<D> cells{}, before{}, size{},
      stride{};              // `size` with layers, without the empty rim; `stride` with it
  Vec<D> min, max, spacing;  // relative to `origin`
  Vec<D> origin = Vec<D>::Zero();
  double cell_volume = 1;
  std::int64_t fill_size = 1;

  Grid(const Shape<D>& shape, const LatticeOptions& o) : min(shape.min()), max(shape.max()) {
    if (is_far<D>(min, max)) {
      origin = min;
      for (int d = 0; d < D; ++d) max[d] = edge_length(min[d], max[d], o.dx);
      min.setZero();
    }
    double count = 1;
    for (std::size_t d = 0; d < D; ++d) {
      const auto e = static_cast<Eigen::Index>(d);
      const double length = max[e] - min[e], wanted = std::round(length / o.dx);
      if (wanted < 1)
        throw InputError(
            fmt::format("make_cloud: spacing {} is larger than the body, which is {} long along {}", o.dx,
                        length, axis_names[d]));
      count *= wanted + o.layers[d][0] + o.layers[d][1] + 2;
      if (count > std::numeric_limits<Index>::max() - lanes)
        throw InputError(
            fmt::format("make_cloud: spacing {} makes more lattice cells than the {} that an index can count",
                        o.dx, std::numeric_limits<Index>::max() - lanes));
      cells[d] = static_cast<std::int64_t>(wanted);
      before[d] = o.layers[d][0];
      size[d] = cells[d] + o.layers[d][0] + o.layers[d][1];
      spacing[e] = length / wanted;
      cell_volume *= spacing[e];
      stride[d] = fill_size;
      fill_size *= size[d] + 2;
    }
  }

  // Coordinate along axis d of the end of the i-th of `pieces` equal ones. Counted from the nearer end: exact
  // at both, and mirrored bodies get mirrored bits.
  double coordinate(std::size_t d, std::int64_t i, std::int64_t pieces) const {
    const auto e = static_cast<Eigen::Index>(d);
    const auto part = [&](std::int64_t k) {
      return (max[e] - min[e]) * static_cast<double>(k) / static_cast<double>(pieces);
    };
    return 2 * i <= pieces ? min[e] + part(i) : max[e] - part(pieces - i);
  }

  // Splits the number of a row (all sites with the same place but for x) into the place of its first site.
  static Place<D> row_place(std::int64_t row, const Place<D>& sites) {
    Place<D> at{};
    for (std::size_t d = 1; d < D; ++d) {
      at[d] = row % sites[d];
      row /= sites[d];
    }
    return at;
  }

  static std::int64_t rows(const Place<D>& sites) {
    std::int64_t n = 1;
    for (std::size_t d = 1; d < D; ++d) n *= sites[d];
    return n;
  }

  // Where in the fill array the cell at `at` stands, counted with the layers.
  std::int64_t fill_at(const Place<D>& at) const {
    std::int64_t k = 0;
    for (std::size_t d = 0; d < D; ++d) k += (at[d] + 1) * stride[d];
    return k;
  }
};

// Serial: a shape is the user's function, which may throw or be unfit for threads.
template <int D>
std::vector<Fill> fill_cells(const Grid<D>& grid, const Shape<D>& shape, int samples) {
  std::vector<Fill> fill(static_cast<std::size_t>(grid.fill_size), 0);
  std::array<std::vector<double>, D> points;
  for (std::size_t d = 0; d < D; ++d)
    for (std::int64_t i = 0; i < grid.cells[d] * samples; ++i)
      points[d].push_back(grid.coordinate(d, 2 * i + 1, 2 * grid.cells[d] * samples));

  const std::int64_t rows = Grid<D>::rows(grid.cells), cell_samples = power(samples, D);
  for (std::int64_t row = 0; row < rows; ++row) {
    Place<D> at = Grid<D>::row_place(row, grid.cells);
    for (at[0] = 0; at[0] < grid.cells[0]; ++at[0]) {
      int inside = 0;
      for (std::int64_t s = 0; s < cell_samples; ++s) {
        Vec<D> X;
        for (std::int64_t d = 0, rest = s; d < D; ++d, rest /= samples) {
          const auto axis = static_cast<std::size_t>(d);
          X[d] = points[axis][static_cast<std::size_t>(at[axis] * samples + rest % samples)];
        }
        inside += shape.contains(grid.origin + X);
      }
      Place<D> place = at;
      for (std::size_t d = 0; d < D; ++d) place[d] += grid.before[d];
      fill[static_cast<std::size_t>(grid.fill_at(place))] = static_cast<Fill>(inside);
    }
  }
  if (grid.size == grid.cells) return fill;

  for (std::int64_t row = 0; row < Grid<D>::rows(grid.size); ++row) {
    Place<D> at = Grid<D>::row_place(row, grid.size);
    for (at[0] = 0; at[0] < grid.size[0]; ++at[0]) {
      Place<D> nearest = at;
      for (std::size_t d = 0; d < D; ++d)
        nearest[d] = std::clamp(at[d], grid.before[d], grid.before[d] + grid.cells[d] - 1);
      fill[static_cast<std::size_t>(grid.fill_at(at))] =
          fill[static_cast<std::size_t>(grid.fill_at(nearest))];
    }
  }
  return fill;
}

// The finaliser of SplitMix64 (Steele, Lea and Flood 2014): the same bits on every machine, unlike the
// standard library's distributions.
std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

// Uniform in [-1, 1) along each axis, from the seed and the place in the body's own lattice.
template <int D>
Vec<D> random_vector(unsigned seed, const Place<D>& place) {
  std::uint64_t state = mix(seed);
  for (const std::int64_t i : place) state = mix(state ^ static_cast<std::uint64_t>(i));
  Vec<D> v;
  for (int d = 0; d < D; ++d) {
    state = mix(state);
    v[d] = static_cast<double>(state >> 11) * 0x1p-52 - 1;
  }
  return v;
}

// What a site's surroundings say: the `width`^D cells from its first one on, two along each axis around a
// node, three around a cell.
template <int D>
struct Stencil {
  int width;
  std::vector<std::int64_t> offset;
  std::vector<std::array<int, D>> side;  // -1 below the site, 0 level with it, 1 above

  Stencil(const Grid<D>& grid, Lattice lattice) : width(lattice == Lattice::node_centred ? 2 : 3) {
    for (std::int64_t c = 0; c < power(width, D); ++c) {
      std::int64_t at = 0, rest = c;
      std::array<int, D> s{};
      for (std::size_t d = 0; d < D; ++d, rest /= width) {
        const auto step = static_cast<int>(rest % width);
        at += step * grid.stride[d];
        s[d] = width == 2 ? 2 * step - 1 : step - 1;
      }
      offset.push_back(at);
      side.push_back(s);
    }
  }
  std::size_t size() const { return offset.size(); }
  // The cells that a site owns a part of: all around a node, the middle one of a cell.
  std::size_t own_begin() const { return width == 2 ? 0 : size() / 2; }
  std::size_t own_end() const { return width == 2 ? size() : size() / 2 + 1; }
};

// The lattice cells with anything inside, in the order of their lowest corners. `sites` counts the nodes
// along each axis and `begin` the particles before each row of them.
template <int D>
void list_cells(const Grid<D>& grid, const std::vector<Fill>& fill, const Place<D>& sites,
                const std::vector<std::int64_t>& begin, std::int64_t full, Cloud<D>& cloud) {
  constexpr std::size_t corners = 1 << D, row_corners = corners / 2;
  bool whole = true;
  for (std::int64_t row = 0; row < Grid<D>::rows(grid.size); ++row) {
    const Place<D> first = Grid<D>::row_place(row, grid.size);
    // The next particle of each row of nodes along the edges of this row of cells, and whether a cell around
    // the node is inside: those of a node's row at x - 1 and x.
    std::array<std::int64_t, row_corners> next{}, around{};
    for (std::size_t r = 0; r < row_corners; ++r) {
      std::int64_t node_row = 0, rows_before = 1, k = 0;
      for (std::size_t d = 1; d < D; ++d) {
        const auto at = first[d] + static_cast<std::int64_t>(r >> (d - 1) & 1);
        node_row += at * rows_before;
        rows_before *= sites[d];
        k += at * grid.stride[d];
      }
      next[r] = begin[static_cast<std::size_t>(node_row)];
      around[r] = k;
    }
    const auto is_particle = [&](std::size_t r, std::int64_t x) {
      for (std::size_t c = 0; c < corners; ++c) {
        std::int64_t k = around[r] + x;
        for (std::size_t d = 0; d < D; ++d) k += static_cast<std::int64_t>(c >> d & 1) * grid.stride[d];
        if (fill[static_cast<std::size_t>(k)] > 0) return true;
      }
      return false;
    };
    Place<D> at = first;
    for (at[0] = 0; at[0] < grid.size[0]; ++at[0]) {
      const Fill inside = fill[static_cast<std::size_t>(grid.fill_at(at))];
      if (inside > 0) {
        std::array<Index, corners> cell;
        for (std::size_t c = 0; c < corners; ++c)
          cell[c] = static_cast<Index>(next[c >> 1] + static_cast<std::int64_t>(c & 1));
        cloud.cells.push_back(cell);
        cloud.cell_share.push_back(static_cast<double>(inside) / static_cast<double>(full));
        whole = whole && inside == full;
      }
      for (std::size_t r = 0; r < row_corners; ++r) next[r] += is_particle(r, at[0]);
    }
  }
  if (whole) cloud.cell_share = {};
}

// The faces at which the fill of cells changes, each owned by the fuller one's particle. Their moments are
// those of the filled part of the cells: sum x_f (x) A_f = (sum V) I. `begin` counts the particles before
// each row of cells.
template <int D>
void list_facets(const Grid<D>& grid, const std::vector<Fill>& fill, const std::vector<std::int64_t>& begin,
                 std::int64_t full, Cloud<D>& cloud) {
  const Vec<D> area = grid.cell_volume * grid.spacing.cwiseInverse();
  for (std::int64_t row = 0; row < Grid<D>::rows(grid.size); ++row) {
    Place<D> at = Grid<D>::row_place(row, grid.size);
    auto p = static_cast<std::size_t>(begin[static_cast<std::size_t>(row)]);
    for (at[0] = 0; at[0] < grid.size[0]; ++at[0]) {
      const std::int64_t k = grid.fill_at(at), inside = fill[static_cast<std::size_t>(k)];
      if (inside == 0) continue;
      for (std::size_t d = 0; d < D; ++d)
        for (const int side : {-1, 1}) {
          const std::int64_t excess = inside - fill[static_cast<std::size_t>(k + side * grid.stride[d])];
          if (excess <= 0) continue;
          const auto e = static_cast<Eigen::Index>(d);
          Facet<D> facet{cloud.X[p], Vec<D>::Zero(), static_cast<Index>(p)};
          facet.centre[e] = grid.coordinate(d, at[d] - grid.before[d] + (side > 0), grid.cells[d]);
          facet.area[e] = side * area[e] * static_cast<double>(excess) / static_cast<double>(full);
          cloud.facets.push_back(facet);
        }
      ++p;
    }
  }
}

// What the cloud keeps of its lattice: numbers of sites are filled in by the caller where not all have a
// particle.
template <int D>
Occupancy<D> occupancy_of(const Grid<D>& grid, const std::vector<Fill>& fill, bool nodes, std::int64_t full) {
  Occupancy<D> o;
  o.nodes = nodes;
  o.spacing = grid.spacing;
  o.whole = static_cast<Fill>(full);
  for (std::size_t d = 0; d < D; ++d) o.size[d] = static_cast<Index>(grid.size[d]);
  std::vector<Fill> inner;
  inner.reserve(o.cells());
  for (std::int64_t row = 0; row < Grid<D>::rows(grid.size); ++row) {
    const auto first =
        fill.begin() + static_cast<std::ptrdiff_t>(grid.fill_at(Grid<D>::row_place(row, grid.size)));
    inner.insert(inner.end(), first, first + static_cast<std::ptrdiff_t>(grid.size[0]));
  }
  o.gapless = std::all_of(inner.begin(), inner.end(), [](Fill f) { return f > 0; });
  if (std::any_of(inner.begin(), inner.end(), [&](Fill f) { return f != o.whole; }))
    o.fill = std::move(inner);
  return o;
}

}  // namespace

template <int D>
Cloud<D> make_cloud(const Shape<D>& shape, const LatticeOptions& options) {
  check(options, D);
  const Grid<D> grid(shape, options);
  const std::vector<Fill> fill = fill_cells(grid, shape, options.samples);
  const bool nodes = options.lattice == Lattice::node_centred;
  const Stencil<D> stencil(grid, options.lattice);

  Place<D> sites = grid.size;
  if (nodes)
    for (auto& n : sites) ++n;
  const std::int64_t rows = Grid<D>::rows(sites);

  // The fill of the first stencil cell of a row's first site; site i of the row is i further on.
  const auto row_fill = [&](const Place<D>& first) {
    std::int64_t k = 0;
    for (std::size_t d = 0; d < D; ++d) k += first[d] * grid.stride[d];
    return fill.data() + k;
  };
  const auto own_fill = [&](const Fill* cell) {
    std::int64_t sum = 0;
    for (std::size_t c = stencil.own_begin(); c < stencil.own_end(); ++c) sum += cell[stencil.offset[c]];
    return sum;
  };

  std::vector<std::int64_t> begin(static_cast<std::size_t>(rows) + 1, 0);
#pragma omp parallel for schedule(static)
  for (std::int64_t row = 0; row < rows; ++row) {
    const Fill* cell = row_fill(Grid<D>::row_place(row, sites));
    std::int64_t count = 0;
    for (std::int64_t i = 0; i < sites[0]; ++i) count += own_fill(cell + i) > 0;
    begin[static_cast<std::size_t>(row) + 1] = count;
  }
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) begin[row + 1] += begin[row];
  const auto n = static_cast<std::size_t>(begin.back());
  if (n == 0)
    throw InputError(fmt::format(
        "make_cloud: the body is empty: no cell of a lattice of spacing {} is inside", options.dx));

  const bool divides = ((grid.spacing.array() - options.dx).abs() <= 1e-9 * options.dx).all();
  Cloud<D> cloud;
  cloud.dx = divides ? options.dx : edge_of<D>(grid.cell_volume);
  cloud.origin = grid.origin;
  cloud.body_volume = estimate_volume(shape, (shape.max() - shape.min()).prod() / grid.cell_volume);
  cloud.X.resize(n);
  cloud.V.resize(n);
  if (nodes) cloud.B.resize(n);
  if (grid.size != grid.cells) cloud.extra.resize(n);
  auto body = std::make_shared<Occupancy<D>>(occupancy_of<D>(grid, fill, nodes, power(options.samples, D)));
  body->particles = n;
  if (!body->gapless) body->sites.resize(n);

  const std::int64_t full = power(options.samples, D);
  const std::int64_t interior = full * static_cast<std::int64_t>(stencil.size());
  const std::int64_t owners = nodes ? power(2, D) : 1;  // sites that share a cell
  const double volume = grid.cell_volume / static_cast<double>(owners * full);
  const Vec<D> area = 2 * volume * grid.spacing.cwiseInverse();  // a cell's face, shared by its 2^(D-1) nodes

#pragma omp parallel for schedule(static)
  for (std::int64_t row = 0; row < rows; ++row) {
    Place<D> at = Grid<D>::row_place(row, sites);
    const Fill* cell = row_fill(at);
    auto p = static_cast<std::size_t>(begin[static_cast<std::size_t>(row)]);
    for (at[0] = 0; at[0] < sites[0]; ++at[0], ++cell) {
      const std::int64_t own = own_fill(cell);
      if (own == 0) continue;
      std::int64_t around = 0;
      std::array<std::int64_t, D> excess{};  // fill above the site less fill below it
      for (std::size_t c = 0; c < stencil.size(); ++c) {
        const std::int64_t f = cell[stencil.offset[c]];
        around += f;
        for (std::size_t d = 0; d < D; ++d) excess[d] += stencil.side[c][d] * f;
      }
      Place<D> place = at;
      bool extra = false;
      for (std::size_t d = 0; d < D; ++d) {
        const auto e = static_cast<Eigen::Index>(d);
        place[d] -= grid.before[d];
        extra |= place[d] < 0 || place[d] >= grid.cells[d] + (nodes ? 1 : 0);
        cloud.X[p][e] = grid.coordinate(d, 2 * place[d] + (nodes ? 0 : 1), 2 * grid.cells[d]);
        if (nodes) cloud.B[p][e] = -area[e] * static_cast<double>(excess[d]);
      }
      if (options.jitter > 0 && around == interior)
        cloud.X[p] += options.jitter * grid.spacing.cwiseProduct(random_vector<D>(options.seed, place));
      cloud.V[p] = volume * static_cast<double>(own);
      if (!cloud.extra.empty()) cloud.extra[p] = extra;
      if (!body->sites.empty()) body->sites[p] = static_cast<Index>(row * sites[0] + at[0]);
      ++p;
    }
  }
  if (!nodes) list_facets<D>(grid, fill, begin, full, cloud);
  if (nodes && options.cells) list_cells<D>(grid, fill, sites, begin, full, cloud);
  cloud.body = std::move(body);
  return cloud;
}

template Cloud<1> make_cloud<1>(const Shape<1>&, const LatticeOptions&);
template Cloud<2> make_cloud<2>(const Shape<2>&, const LatticeOptions&);
template Cloud<3> make_cloud<3>(const Shape<3>&, const LatticeOptions&);

}  // namespace taut
