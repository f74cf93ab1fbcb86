#include <lib/names.hpp>
#include <taut/formulations/auto_method.hpp>
#include <taut/formulations/formulation.hpp>
#include <taut/integrators/integrator.hpp>
#include <taut/kernels/kernel.hpp>
#include <taut/materials/material.hpp>
#include <taut/operators/operators.hpp>

namespace taut::bench {

const Names& names() {
  static const Names all = {formulation_names(), operator_names(),         Kernel::names(),
                            material_names(),    {"cell_list", "kd_tree"}, integrator_names()};
  return all;
}

bool has_pairs(const std::string& formulation) { return formulation != "tl_stress_points"; }
double default_support(const std::string& formulation, const std::string& operators) {
  // Particles that change neighbours, and quadratic fits, need more of them.
  return formulation.starts_with("ul_") || operators == "quadratic" ? 2.4 : with_defaults({}).support_dx;
}
double default_control(const std::string& formulation) { return has_pairs(formulation) ? 0 : 1; }

}  // namespace taut::bench
