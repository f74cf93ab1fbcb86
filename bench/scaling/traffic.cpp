#include <scaling/engine_step.hpp>
#include <scaling/traffic.hpp>
#include <taut/formulations/assembly.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/neighbors/search.hpp>
#include <taut/operators/operators.hpp>

namespace taut::bench {
namespace {

constexpr double value = sizeof(double);

// The kick of a whole step and the drift: u, v and a are read, u and v written.
template <int D>
constexpr double integrator_bytes = 5 * D* value;
template <int D>
constexpr double integrator_flops = 4 * D;

template <int D>
Particles<D> particles_of(const Cloud<D>& cloud, const char* material, double reach) {
  return assemble<D>(cloud, {make_material<D>(material, step_parameters())},
                     std::vector<std::uint8_t>(cloud.size(), 0), {{}, {}, reach});
}

template <int D>
PairList pairs_of(const Particles<D>& p, double radius) {
  return find_pairs<D>(points_of<D>(p.X, p.total), radius);
}

}  // namespace

template <int D>
Traffic total_lagrangian_traffic(const Cloud<D>& cloud, const Method& method) {
  const double support = method.support_dx * cloud.dx;
  const Kernel kernel(method.kernel, D);
  const Particles<D> p = particles_of<D>(cloud, "neo_hookean", support);
  const PairList pairs = pairs_of(p, support);
  const PairOperator<D> op = make_operator<D>(method, p, pairs, kernel, support / kernel.radius_factor());
  const auto n = static_cast<double>(cloud.size());
  const bool recomputed = op.precision == PairPrecision::recomputed;

  // Masks of slots are for recomputed vectors only. Shared vectors and matrices stay in the cache, and with
  // the vectors come the slots, in place of the list's but for index blocks; those of regular lattices stay
  // there, too, yet are counted once as if they did not.
  const bool shared = op.precision == PairPrecision::shared;
  const auto slots = static_cast<double>(pairs.slots());
  const auto list = shared ? (1 - pairs.contiguous_fraction()) * slots * lanes * sizeof(Index)
                           : static_cast<double>(pairs.bytes()) - (recomputed ? 0 : slots);
  const auto payload = static_cast<double>(op.vectors_f.bytes() + op.vectors_d.bytes() +
                                           op.slice_slots.bytes() + op.slots.bytes());
  const auto adjoint = op.adjoint_f.empty() && op.adjoint_d.empty()
                           ? payload
                           : static_cast<double>(op.adjoint_f.bytes() + op.adjoint_d.bytes());
  const auto matrices = static_cast<double>(op.M.bytes() + op.slice_code.bytes());
  const auto sums = static_cast<double>(op.sum.bytes() + op.slice_code.bytes());
  const double per_particle =  // weights and X, in both passes
      recomputed ? static_cast<double>(op.weight.bytes()) / n + D * value : 0;

  const double gradient_pass =
      (list + payload + matrices) / n + per_particle + (D + 1 + D * D) * value;                    // u, V; Q
  const double force_pass = (list + adjoint + sums) / n + per_particle + (D * D + 1 + D) * value;  // Q, m; a
  // Recomputed, in both passes: differences, r^2, the kernel's table, scaling.
  constexpr double geometry = 5 * D + 10;
  const double pair_flops = (D + 2 * D * D) + 2 * D * D + (recomputed ? 2 * geometry : 0);
  constexpr double stress[] = {8, 30, 85};  // inverse, J, ln J and P in 1D, 2D, 3D
  constexpr double bounds[] = {2, 12, 30};  // of the stretches
  const double particle_flops = 4 * D * D * D + D * D + 2 * D * D + 2 * D + stress[D - 1] +
                                bounds[D - 1];  // sum M^T, P M; V, Q s, 1 / m
  return {gradient_pass + force_pass + integrator_bytes<D>,
          pair_flops * static_cast<double>(pairs.pairs()) / n + particle_flops + integrator_flops<D>};
}

template <int D>
Traffic updated_lagrangian_traffic(const Cloud<D>& cloud, const Method& method, int rebuild_every) {
  const double support = method.support_dx * cloud.dx;
  const Particles<D> p = particles_of<D>(cloud, "hypoelastic", support);
  const PairList pairs = pairs_of(p, support * (1 + method.skin));
  const auto n = static_cast<double>(cloud.size());
  const double list = static_cast<double>(pairs.bytes() - static_cast<std::size_t>(pairs.slots())) / n;
  constexpr int S = sym_components<D>;
  const double positions = 3 * D * value;   // X, u; x
  const double skin_check = 2 * D * value;  // x, place of the last build
  const double rates =
      list + (2 * D + 1 + 1 + S + 1) * value + (S + 1 + 1) * value;         // x, v, m, rho, s, rho; rates
  const double evolved = 3 * (S + 2) * value;                               // value, rate; value
  const double stress = (S + 2) * value + S * value;                        // s, rho, rho; T
  const double accelerations = list + (2 * D + S + 2) * value + D * value;  // x, v, T, m, rho; a
  const double rebuild = (static_cast<double>(pairs.bytes()) / n + 2 * D * value) / rebuild_every;
  constexpr double geometry = 3 * D + 10 + 1;  // differences, r^2, kernel table, mass
  const double pair_flops = 2 * geometry + (D + D + 2 * D * D) + (S + D + 2 * D * D);
  constexpr double law[] = {15, 45, 90};  // rates and stress of the material in 1D, 2D, 3D
  const double particle_flops = 2 * D * D + law[D - 1] + 3 * S + 8;
  return {positions + skin_check + rates + evolved + stress + accelerations + rebuild + integrator_bytes<D>,
          pair_flops * static_cast<double>(pairs.pairs()) / n + particle_flops + integrator_flops<D>};
}

#define TAUT_INSTANTIATE(D)                                                     \
  template Traffic total_lagrangian_traffic<D>(const Cloud<D>&, const Method&); \
  template Traffic updated_lagrangian_traffic<D>(const Cloud<D>&, const Method&, int);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut::bench
