// taut-compare with a kernel, a material, operators and a formulation that taut does not have.
#include <cstdio>
#include <taut/compare.hpp>

#include "parts.hpp"

int main(int argc, char** argv) {
  try {
    taut::add_kernel(wendland_c4());
    taut::material_registry().add(stiffening());
    taut::operator_registry().add(volume_corrected());
    taut::formulation_registry().add(tl_plain());
  } catch (const taut::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return taut::compare_main(argc, argv);
}
