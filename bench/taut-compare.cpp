// taut-compare SCENE…: the same scene under each formulation it lists, beside the truth; or, with
// --tolerance, the cheapest of many that is near enough to it.

#include <lib/options.hpp>
#include <taut/compare.hpp>

int main(int argc, char** argv) {
  taut::bench::sleep_while_waiting(argv);
  return taut::compare_main(argc, argv);
}
