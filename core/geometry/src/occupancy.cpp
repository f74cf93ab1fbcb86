#include <taut/geometry/occupancy.hpp>

namespace taut {

template <int D>
const Occupancy<D>* lattice_of(const Cloud<D>& cloud) {
  const Occupancy<D>* lattice = cloud.body.get();
  if (!lattice || lattice->particles != cloud.size()) return nullptr;
  // Neighbours on the lattice are neighbours in space, whatever became of their cells.
  constexpr double far = 4;
  for (std::size_t id = 1; id < cloud.size(); ++id) {
    const bool next = lattice->sites.empty() || lattice->sites[id] == lattice->sites[id - 1] + 1;
    const Index row = lattice->size[0] + (lattice->nodes ? 1 : 0);
    const Index number = lattice->sites.empty() ? static_cast<Index>(id) : lattice->sites[id];
    if (next && number % row != 0 && !((cloud.X[id] - cloud.X[id - 1]).norm() <= far * cloud.dx))
      return nullptr;
  }
  return lattice;
}

template const Occupancy<1>* lattice_of<1>(const Cloud<1>&);
template const Occupancy<2>* lattice_of<2>(const Cloud<2>&);
template const Occupancy<3>* lattice_of<3>(const Cloud<3>&);

}  // namespace taut
