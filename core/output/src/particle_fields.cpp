#include <fmt/format.h>

#include <Eigen/LU>
#include <taut/base/error.hpp>
#include <taut/base/parallel.hpp>
#include <taut/output/derived.hpp>
#include <taut/output/particle_fields.hpp>
#include <taut/simulation/simulation_impl.hpp>

namespace taut {

namespace {

template <int D>
struct Reader {
  const Simulation<D>& simulation;
  const SimulationImpl<D>& impl;

  Vec<D> displacement(std::size_t id) const {
    return impl.particles.u.template vec<D>(static_cast<std::size_t>(impl.place(id)));
  }
  Mat<3> stress(std::size_t id) const { return impl.formulation->full_cauchy_stress(impl.place(id)); }
};

template <class Matrix>
void write(const Matrix& matrix, double* out) {
  for (int r = 0; r < matrix.rows(); ++r)
    for (int c = 0; c < matrix.cols(); ++c) *out++ = matrix(r, c);
}

template <int D>
struct Entry {
  const char* name;
  int components;
  void (*read)(const Reader<D>& s, std::size_t id, double* out);
};

template <int D>
const std::vector<Entry<D>>& entries() {
  using R = const Reader<D>&;
  static const std::vector<Entry<D>> table = {
      {"reference_position", D,
       [](R s, std::size_t id, double* out) { write(s.impl.reference_position(id), out); }},
      {"position", D,
       [](R s, std::size_t id, double* out) {
         write(Vec<D>(s.impl.cloud.origin + (s.impl.cloud.X[id] + s.displacement(id))), out);
       }},
      {"displacement", D, [](R s, std::size_t id, double* out) { write(s.displacement(id), out); }},
      {"velocity", D,
       [](R s, std::size_t id, double* out) {
         write(s.impl.particles.v.template vec<D>(static_cast<std::size_t>(s.impl.place(id))), out);
       }},
      {"mass", 1, [](R s, std::size_t id, double* out) { *out = s.simulation.mass(id); }},
      {"cauchy_stress", 9, [](R s, std::size_t id, double* out) { write(s.stress(id), out); }},
      {"von_mises", 1, [](R s, std::size_t id, double* out) { *out = von_mises(s.stress(id)); }},
      {"pressure", 1, [](R s, std::size_t id, double* out) { *out = pressure(s.stress(id)); }},
      {"principal_stress", 3,
       [](R s, std::size_t id, double* out) { write(principal_stresses(s.stress(id)), out); }},
      {"first_piola_kirchhoff", D * D,
       [](R s, std::size_t id, double* out) {
         write(s.impl.formulation->first_piola_kirchhoff(s.impl.place(id)), out);
       }},
      {"deformation_gradient", D * D,
       [](R s, std::size_t id, double* out) {
         write(s.impl.formulation->deformation_gradient(s.impl.place(id)), out);
       }},
      {"J", 1,
       [](R s, std::size_t id, double* out) {
         *out = s.impl.formulation->deformation_gradient(s.impl.place(id)).determinant();
       }},
  };
  return table;
}

template <int D>
const Entry<D>& entry_of(std::string_view name) {
  for (const Entry<D>& entry : entries<D>())
    if (name == entry.name) return entry;
  throw InputError(fmt::format("unknown field \"{}\"; valid: {}", name, join_names(field_names())));
}

}  // namespace

std::vector<std::string> field_names() {
  std::vector<std::string> names;
  for (const auto& entry : entries<1>()) names.emplace_back(entry.name);
  return names;
}

int field_components(std::string_view name, int dimension) {
  if (dimension == 1) return entry_of<1>(name).components;
  if (dimension == 2) return entry_of<2>(name).components;
  if (dimension == 3) return entry_of<3>(name).components;
  throw InputError(fmt::format("fields have 1, 2 or 3 dimensions, not {}", dimension));
}

template <int D>
void read_field(const Simulation<D>& simulation, std::string_view name, std::span<double> out) {
  const Entry<D>& entry = entry_of<D>(name);
  const SimulationImpl<D>& impl = simulation.impl();
  if (!impl.formulation)
    throw InputError(fmt::format("the field {} is known only after prepare, run or relax", name));
  const auto components = static_cast<std::size_t>(entry.components);
  const std::size_t n = simulation.size();
  if (out.size() != n * components)
    throw InputError(fmt::format("the field {} of {} particles has {} values; there is room for {}", name, n,
                                 n * components, out.size()));
  impl.look();
  const Reader<D> reader{simulation, impl};
  parallel_for(n, worth_threads(static_cast<std::int64_t>(n)),
               [&](std::size_t id) { entry.read(reader, id, out.data() + id * components); });
}

template <int D>
std::vector<double> read_field(const Simulation<D>& simulation, std::string_view name) {
  std::vector<double> values(simulation.size() * static_cast<std::size_t>(field_components(name, D)));
  read_field<D>(simulation, name, values);
  return values;
}

#define TAUT_INSTANTIATE(D)                                                               \
  template void read_field<D>(const Simulation<D>&, std::string_view, std::span<double>); \
  template std::vector<double> read_field<D>(const Simulation<D>&, std::string_view);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut
