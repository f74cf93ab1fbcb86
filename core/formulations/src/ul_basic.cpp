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

template <int D>
std::unique_ptr<Formulation<D>> make_ul_basic(const FormulationSetup<D>& setup) {
  return std::make_unique<UlBasic<D>>(setup);
}
template std::unique_ptr<Formulation<1>> make_ul_basic<1>(const FormulationSetup<1>&);
template std::unique_ptr<Formulation<2>> make_ul_basic<2>(const FormulationSetup<2>&);
template std::unique_ptr<Formulation<3>> make_ul_basic<3>(const FormulationSetup<3>&);

}  // namespace taut
