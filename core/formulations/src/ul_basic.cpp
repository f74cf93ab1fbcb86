#include <taut/formulations/formulations.hpp>
#include <taut/formulations/updated_lagrangian.hpp>

namespace taut {

namespace {

/// Plain updated Lagrangian SPH (Tran-Duc et al. 2023, there CCB-SPH): fails in tension (Swegle, Hicks &
/// Attaway 1995), which is why it is here.
template <int D>
class UlBasic final : public UpdatedLagrangian<D> {
 public:
  using UpdatedLagrangian<D>::UpdatedLagrangian;
  void update_accelerations(double t) override {
    this->update_stress();
    this->acceleration_pass(NoPairTerm{});
    this->finish_accelerations(t);
  }
};

}  // namespace

FormulationEntry ul_basic_entry() {
  return {.name = "ul_basic",
          .line = "updated Lagrangian, stress by Jaumann's rate, pressure by an equation of state",
          .fails = "tension: particles clump and the body tears (tensile instability)",
          .make = formulation_makers<UlBasic>(),
          .traits = updated_lagrangian_traits(),
          .parameters = updated_lagrangian_parameters()};
}

}  // namespace taut
