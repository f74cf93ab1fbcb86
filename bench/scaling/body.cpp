#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <scaling/body.hpp>
#include <taut/base/error.hpp>

namespace taut::bench {

const char* to_string(Arrangement arrangement) {
  return arrangement == Arrangement::lattice ? "lattice" : "jittered";
}

template <int D>
Cloud<D> cube(std::int64_t particles, Arrangement arrangement) {
  const double edge = std::round(std::pow(static_cast<double>(particles), 1.0 / D));
  return make_cloud(box<D>(Vec<D>::Zero(), Vec<D>::Ones()),
                    {.dx = 1 / edge,
                     .lattice = Lattice::cell_centred,
                     .jitter = arrangement == Arrangement::lattice ? 0 : 0.2});
}

// On a lattice the radius lies between two shells of neighbours, that with the skin as well; a jittered cloud
// has count + 1 particles in a ball of that radius.
template <int D>
const std::vector<Neighbourhood>& neighbourhoods(Arrangement arrangement) {
  static const std::vector<Neighbourhood> lattice =
      D == 1 ? std::vector<Neighbourhood>{{2, 1.5, 0.1}, {4, 2.5, 0.1}, {6, 3.5, 0.1}}
      : D == 2
          ? std::vector<Neighbourhood>{{8, 1.5, 0.1}, {12, 2.05, 0.08}, {20, 2.5, 0.1}, {36, 3.2, 0.1}}
          : std::vector<Neighbourhood>{{18, 1.5, 0.1}, {32, 2.05, 0.08}, {56, 2.25, 0.08}, {80, 2.55, 0.1}};
  static const std::vector<Neighbourhood> jittered = [] {
    std::vector<Neighbourhood> all = lattice;
    const double ball = D == 1 ? 2 : D == 2 ? M_PI : 4 * M_PI / 3;
    for (Neighbourhood& n : all) n.support_dx = std::pow((n.neighbours + 1) / ball, 1.0 / D);
    return all;
  }();
  return arrangement == Arrangement::lattice ? lattice : jittered;
}

template <int D>
const Neighbourhood& neighbourhood(int neighbours, Arrangement arrangement) {
  const auto& all = neighbourhoods<D>(arrangement);
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const Neighbourhood& n) { return n.neighbours == neighbours; });
  if (found != all.end()) return *found;
  std::vector<std::string> valid;
  for (const Neighbourhood& n : all) valid.push_back(fmt::format("{}", n.neighbours));
  throw InputError(fmt::format("no cube in {}D has particles of {} neighbours; valid: {}", D, neighbours,
                               join_names(valid)));
}

#define TAUT_INSTANTIATE(D)                                                  \
  template Cloud<D> cube<D>(std::int64_t, Arrangement);                      \
  template const std::vector<Neighbourhood>& neighbourhoods<D>(Arrangement); \
  template const Neighbourhood& neighbourhood<D>(int, Arrangement);
TAUT_INSTANTIATE(1)
TAUT_INSTANTIATE(2)
TAUT_INSTANTIATE(3)
#undef TAUT_INSTANTIATE

}  // namespace taut::bench
