#include <algorithm>
#include <cmath>
#include <taut/geometry/occupancy.hpp>
#include <taut/particles/interfaces.hpp>

namespace taut {

template <int D>
bool Interfaces<D>::known(const Cloud<D>& cloud) {
  const Occupancy<D>* lattice = lattice_of(cloud);
  return lattice && lattice->nodes;
}

template <int D>
Interfaces<D>::Interfaces(const Cloud<D>& cloud) {
  const Occupancy<D>& lattice = *cloud.body;
  std::array<Index, D> stride;  // of nodes, by their numbers
  Index nodes = 1;
  for (std::size_t d = 0; d < D; ++d) {
    stride[d] = nodes;
    nodes *= lattice.size[d] + 1;
  }
  std::vector<Index> particle(static_cast<std::size_t>(nodes), no_particle);
  for (std::size_t id = 0; id < cloud.size(); ++id)
    particle[lattice.sites.empty() ? id : static_cast<std::size_t>(lattice.sites[id])] =
        static_cast<Index>(id);
  for (std::size_t cell = 0; cell < lattice.cells(); ++cell) {
    if (lattice.filled(cell) == 0) continue;
    Index lowest = 0;
    auto rest = static_cast<Index>(cell);
    for (std::size_t d = 0; d < D; ++d) {
      lowest += rest % lattice.size[d] * stride[d];
      rest /= lattice.size[d];
    }
    std::array<Index, 1 << D> corners;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      Index node = lowest;
      for (std::size_t d = 0; d < D; ++d) node += static_cast<Index>(c >> d & 1) * stride[d];
      corners[c] = particle[static_cast<std::size_t>(node)];
    }
    cells_.push_back(static_cast<Index>(cell));
    corners_.push_back(corners);
  }
  material_.assign(cells_.size(), 0);
  share_out(cloud);
}

template <int D>
void Interfaces<D>::assign(const Cloud<D>& cloud, const std::function<bool(const Vec<D>&)>& where,
                           std::uint8_t material) {
  bool any = false;
  for (std::size_t q = 0; q < cells_.size(); ++q) {
    Vec<D> centre = Vec<D>::Zero();
    for (const Index corner : corners_[q]) centre += cloud.X[static_cast<std::size_t>(corner)];
    if (!where(cloud.origin + centre / (1 << D))) continue;
    material_[q] = material;
    any = true;
  }
  resolved_ = resolved_ && any;
  share_out(cloud);
}

template <int D>
void Interfaces<D>::share_out(const Cloud<D>& cloud) {
  const Occupancy<D>& lattice = *cloud.body;
  // Fills around each particle, and those above it less those below, by material: whole numbers.
  struct Sum {
    std::uint8_t material = 0;
    std::int64_t own = 0;
    std::array<std::int64_t, D> excess{};
  };
  struct Around {
    std::array<Sum, 1 << D> sum;
    std::size_t count = 0;
  };
  constexpr std::uint8_t none = 255;  // materials are fewer
  std::vector<std::uint8_t> only(cloud.size(), none);
  std::vector<Index> mixed(cloud.size(), no_particle);  // where in `around` those of several materials stand
  std::vector<Around> around;
  for (std::size_t q = 0; q < cells_.size(); ++q)
    for (const Index corner : corners_[q]) {
      std::uint8_t& m = only[static_cast<std::size_t>(corner)];
      if (m == none) m = material_[q];
      if (m == material_[q] || mixed[static_cast<std::size_t>(corner)] != no_particle) continue;
      mixed[static_cast<std::size_t>(corner)] = static_cast<Index>(around.size());
      around.emplace_back();
    }
  for (std::size_t q = 0; q < cells_.size(); ++q) {
    const std::int64_t fill = lattice.filled(static_cast<std::size_t>(cells_[q]));
    for (std::size_t c = 0; c < corners_[q].size(); ++c) {
      const Index at = mixed[static_cast<std::size_t>(corners_[q][c])];
      if (at == no_particle) continue;
      Around& a = around[static_cast<std::size_t>(at)];
      std::size_t k = 0;
      while (k < a.count && a.sum[k].material != material_[q]) ++k;
      if (k == a.count) a.sum[a.count++].material = material_[q];
      a.sum[k].own += fill;
      for (std::size_t d = 0; d < D; ++d) a.sum[k].excess[d] += (c >> d & 1) ? -fill : fill;
    }
  }
  Vec<D> area;  // of a cell's face, shared by its 2^(D-1) nodes, for a fill of one
  for (int d = 0; d < D; ++d)
    area[d] = 2 * (lattice.spacing.prod() / lattice.spacing[d]) / ((1 << D) * lattice.whole);
  begin_.assign(1, 0);
  parts_.clear();
  for (std::size_t id = 0; id < cloud.size(); ++id) {
    if (mixed[id] == no_particle) {
      parts_.push_back({only[id], cloud.V[id], cloud.B.empty() ? Vec<D>(Vec<D>::Zero()) : cloud.B[id]});
    } else {
      Around& a = around[static_cast<std::size_t>(mixed[id])];
      const auto end = a.sum.begin() + static_cast<std::ptrdiff_t>(a.count);
      std::sort(a.sum.begin(), end, [](const Sum& l, const Sum& r) { return l.material < r.material; });
      std::int64_t all = 0;
      for (auto sum = a.sum.begin(); sum != end; ++sum) all += sum->own;
      for (auto sum = a.sum.begin(); sum != end; ++sum) {
        MaterialPart<D> part{
            sum->material, cloud.V[id] * (static_cast<double>(sum->own) / static_cast<double>(all)), {}};
        for (int d = 0; d < D; ++d)
          part.B[d] = -area[d] * static_cast<double>(sum->excess[static_cast<std::size_t>(d)]);
        parts_.push_back(part);
      }
    }
    begin_.push_back(parts_.size());
  }
}

template <int D>
void Interfaces<D>::straighten(Cloud<D>& cloud) const {
  const Occupancy<D>& lattice = *cloud.body;
  const Site<D> first = lattice.site(0);  // on the surface, where nothing is jittered
  const double most = 0.41;               // in spacings: what is further off was not moved by jitter
  std::vector<std::pair<std::size_t, Vec<D>>> moved;
  for (std::size_t id = 0; id < cloud.size(); ++id) {
    if (parts(id).size() < 2) continue;
    const Site<D> site = lattice.site(id);
    Vec<D> X = cloud.X[0], off;
    for (int d = 0; d < D; ++d) {
      const auto e = static_cast<std::size_t>(d);
      X[d] += 0.5 * (site[e] - first[e]) * lattice.spacing[d];
      off[d] = std::abs(cloud.X[id][d] - X[d]) / lattice.spacing[d];
    }
    if (!(off.maxCoeff() <= most)) return;  // no longer along the axes
    if (off.maxCoeff() > 1e-6) moved.emplace_back(id, X);
  }
  for (const auto& [id, X] : moved) cloud.X[id] = X;
}

template class Interfaces<1>;
template class Interfaces<2>;
template class Interfaces<3>;

}  // namespace taut
